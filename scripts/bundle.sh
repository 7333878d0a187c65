#!/usr/bin/env bash
# Everything that a machine with a GPU needs, in build/bundle: the lean glint-bench, its shared libraries (not
# glibc), the GPU tests with and without fused multiply-add, gpu-probe, gpu_check.sh, what ptxas says of each
# kernel, and one packed scene.
#   scripts/bundle.sh [--arch LIST] [--gsplat ARCHIVE] [SCENE_FOLDER_OR_PACKED]
#   scripts/bundle.sh --evidence [--arch LIST] [--profile NAME (small)] [--records FILE] [--data DIR (data)] [--without-tests]
#     [--speed SCENE] [--skip GLOB]...
# The second for card_evidence.sh: glint-bench, the profile with its scenes packed (made below DIR where they are missing: that takes a
# while), as many as there is room for, and cells.txt: cells that have no record in FILE (docs/results/NAME.jsonl), most wanted first.
# LIST: CUDA architectures, default 90. ARCHIVE: gsplat's source, for gsplat_check.sh, with the glm that it
# includes (libglm-dev). Without a scene, a small GlassRoom of 480x270 is made. Exit 4 where bundle and tracked
# files are above 58 MiB together.
set -euo pipefail
cd "$(dirname "$0")/.."

arch=90 gsplat='' scene='' evidence='' profile=small records='' data=data tests=1 speed='' skip=()
while [ $# -gt 0 ]; do
  case $1 in
    --arch) arch=$2; shift 2 ;;
    --gsplat) gsplat=$2; shift 2 ;;
    --evidence) evidence=1; shift ;;
    --profile) profile=$2; shift 2 ;;
    --records) records=$2; shift 2 ;;
    --data) data=$2; shift 2 ;;
    --without-tests) tests=''; shift ;;
    --speed) speed=$2; shift 2 ;;
    --skip) skip+=(--skip "$2"); shift 2 ;;
    -*) echo "bundle: unknown option $1; expected --arch, --gsplat, --evidence, --profile, --records, --data, --without-tests, --speed or --skip" >&2; exit 1 ;;
    *) scene=$1; shift ;;
  esac
done
limit=$((58 * 1024 * 1024))
bundle=build/bundle
build=build/cuda
log=build/bundle.log  # of the compiler: what ptxas says stands there

configure() {
  cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES="$arch" -DCMAKE_CUDA_FLAGS=--resource-usage "$@" \
    >build/configure-cuda.log 2>&1 || { cat build/configure-cuda.log >&2; exit 6; }
}
# Kernels are compiled even where they are up to date, so that ptxas speaks (ccache repeats its words).
build() {
  rm -f $build/glint/CMakeFiles/glint_cuda.dir/cuda/*.cu.o
  cmake --build $build --target "$@" >$log 2>&1 || { tail -n 40 $log >&2; exit 1; }
}
strip_to() {
  mkdir -p "$1"
  local program
  for program in "${@:2}"; do strip -o "$1/$(basename "$program")" "$program"; done
}

# Of ptxas: kernel, registers, bytes of stack frame, of spills, of shared memory.
resource_table() {
  local words=$build/cuda_resources.txt  # where the build keeps them apart
  [ -f $words ] || words=$log
  awk '
    /Compiling entry function/ { split($0, part, "\x27"); kernel = part[2] }
    /bytes stack frame/ { frame = $1; spills = $5 + $9 }
    /Used [0-9]+ registers/ {
      match($0, /Used [0-9]+/); registers = substr($0, RSTART + 5, RLENGTH - 5)
      shared = match($0, /[0-9]+ bytes smem/) ? substr($0, RSTART, RLENGTH - 11) : 0
      if (kernel != "") printf "%9d %9d %9d %9d  %s\n", registers, frame, spills, shared, kernel
      kernel = ""; frame = spills = 0
    }' $words | c++filt | sed 's/glint::gpu:://g; s/glint:://g; s/(anonymous namespace):://g' | sort -k5 | uniq
}

mkdir -p build
rm -rf $bundle
mkdir -p $bundle/lib/cxx
if [ -z "$evidence" ]; then
  configure -DGLINT_CUDA_FMAD=OFF
  build gpu_tests
  strip_to $bundle/bin/no-fmad $build/tests/gpu_tests
fi
configure -DGLINT_CUDA_FMAD=ON
more=()
[ -z "$tests" ] || more=(gpu_tests)
[ -n "$evidence" ] ||
  mapfile -t -O 1 more < <(cmake --build $build --target help | grep -ox 'test_glint_cuda_scale: phony' | sed 's/:.*//')
build glint-bench gpu-probe "${more[@]}"
programs=("$build/bin/glint-bench" "$build/bin/gpu-probe" "${more[@]/#/$build/tests/}")
strip_to $bundle/bin "${programs[@]}"
{ printf '%9s %9s %9s %9s  %s\n' registers frame spills shared "kernel (bytes; CUDA architectures $arch)"; resource_table; } \
  >$bundle/resources.txt

# glibc and the driver's own libraries are the other machine's.
ldd "${programs[@]}" | sed -n 's|.* => \(/[^ ]*\) .*|\1|p' | sort -u |
  grep -vE '/(libc|libm|libdl|libpthread|librt|libresolv|ld-linux-x86-64|libcuda|libnvidia-[a-z]*)\.so' |
  while IFS= read -r library; do cp -L "$library" $bundle/lib/; done
# An older glibc may refuse our C++ runtime, but has one of its own that will do.
mv $bundle/lib/libstdc++.so.6 $bundle/lib/libgcc_s.so.1 $bundle/lib/cxx/
glibc=$(objdump -T $bundle/bin/g* $bundle/lib/*.so* | grep -o 'GLIBC_2\.[0-9]*' | sort -uV | tail -n 1)

cat >$bundle/environment.sh <<'ENVIRONMENT'
# To be sourced: the bundle's libraries, with its C++ runtime where that runs here.
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
unxz_to_output() { if command -v xz >/dev/null; then xz -dc "$1"; else python3 -c 'import lzma, shutil, sys
shutil.copyfileobj(lzma.open(sys.argv[1]), sys.stdout.buffer)' "$1"; fi; }
[ -d "$here/bin" ] || unxz_to_output "$here/programs.tar.xz" | tar -x -C "$here"
export LD_LIBRARY_PATH=$here/lib:$here/lib/cxx${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
"$here/bin/glint-bench" --version >/dev/null 2>&1 || LD_LIBRARY_PATH=${LD_LIBRARY_PATH/":$here/lib/cxx"/}
ENVIRONMENT
cat >$bundle/glint-bench <<'LAUNCHER'
#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
exec "$here/bin/glint-bench" "$@"
LAUNCHER
chmod +x $bundle/glint-bench
if [ -n "$evidence" ]; then cp scripts/card_evidence.sh $bundle/; else cp scripts/gpu_check.sh $bundle/; fi
cp scripts/gsplat_check.sh scripts/gsplat_times.py $bundle/

if [ -n "$gsplat" ]; then
  [ -d /usr/include/glm ] || { echo "bundle: gsplat includes glm; install libglm-dev" >&2; exit 6; }
  mkdir $bundle/gsplat
  cp "$gsplat" $bundle/gsplat/
  tar -cJf $bundle/gsplat/glm.tar.xz -C /usr/include glm
fi

# The scene that gpu_check.sh trains on.
pack_check_scene() {
  if [ -n "$scene" ] && [ -f "$scene" ]; then
    cp "$scene" $bundle/scene.safetensors
  else
    scripts/build.sh release glint-bench
    if [ -z "$scene" ]; then
      scene=data/bundle/room_1
      build/release/bin/glint-bench dataset make glassroom --scene room_1 --width 480 --height 270 --views 8 \
        --spp 8 --out $scene >&2
    fi
    build/release/bin/glint-bench dataset pack "$scene" $bundle/scene.safetensors --test-truth-only >&2
  fi
  $bundle/glint-bench dataset info $bundle/scene.safetensors >&2
}
[ -n "$evidence" ] || pack_check_scene

tar -cf - -C $bundle bin lib | xz -T0 >$bundle/programs.tar.xz  # a third; environment.sh unpacks them
rm -r $bundle/bin $bundle/lib

tree=$(git ls-files -z | xargs -0 stat -c %s 2>/dev/null | awk '{ sum += $1 } END { print sum }')
used() { find $bundle -type f -printf '%s\n' | awk -v tree="$tree" '{ sum += $1 } END { print sum + tree }'; }

# --- what card_evidence.sh works through ---
bench=build/release/bin/glint-bench
name=$(basename "$profile" .toml)
source_profile=$profile
[ -f "$source_profile" ] || source_profile=reports/profiles/$name.toml
packed=()
pack_one() {  # SCENE FOLDER: unless it has no room
  local file=$bundle/scenes/$1.safetensors
  $bench dataset pack "$2" "$file" --compact --without basecolor >&2 || exit 6
  local beyond=$(($(used) - limit))
  if [ $beyond -le 0 ]; then packed+=("$1"); return; fi
  echo "bundle: $1 left out: $(awk -v b=$beyond 'BEGIN { printf "%.1f", b / 1048576 }') MiB too many; it goes into another bundle (--skip what this one has)" >&2
  rm "$file"
}
pack_evidence() {
  mkdir -p $bundle/scenes $bundle/profile
  [ -f "$source_profile" ] || { echo "bundle: no profile $profile" >&2; exit 1; }
  grep -q '^scenes = \["[a-z0-9_", ]*"\]$' "$source_profile" ||
    { echo "bundle: $source_profile: expected scenes = [\"room_1\", ...] in one line, rooms by their names" >&2; exit 1; }
  scripts/build.sh release glint-bench
  [ -z "$speed" ] || $bench dataset pack "$speed" $bundle/scenes/speed.safetensors --compact --without basecolor >&2
  local nothing scene
  nothing=$(mktemp -d)
  $bench status --tasks --quiet --profile "$source_profile" --out "$nothing" --data "$data" "${skip[@]}" | cut -f1 >$build/all_cells.txt
  rm -r "$nothing"
  wanted_cells "${records:-docs/results/$name.jsonl}" <$build/all_cells.txt >$build/cells.txt
  cut -d/ -f1 $build/cells.txt | sort -u >$build/scenes.txt
  [ -s $build/scenes.txt ] || { echo "bundle: every cell of $name has a record" >&2; exit 1; }
  while read -r scene; do
    $bench all --profile "$source_profile" --data "$data" --data-only --only "$scene/*" </dev/null >&2
    pack_one "$scene" "$(room_folder "$scene")"
  done <$build/scenes.txt
  [ ${#packed[@]} -gt 0 ] || { echo "bundle: no room for any scene" >&2; exit 4; }
  grep -E "^($(IFS='|'; echo "${packed[*]}"))/" $build/cells.txt >$bundle/cells.txt
  packed_profile >$bundle/profile/"$name".toml
}
room_folder() { ls -dt "$data"/glassroom/"$1"-*/ | head -n 1; }  # the newest: it was just made or checked
packed_profile() {
  local list='' scene
  for scene in "${packed[@]}"; do list+="{scene = \"$scene\", dataset = \"glassroom\", folder = \"$scene.safetensors\"}, "; done
  sed "s|^scenes = .*|scenes = [${list%, }]|; /^\[defaults\]/,/^\[mesh\]/ { /^\[mesh\]/!d }" "$source_profile"
}
# Of the cells on standard input those without a finished record: seed by seed, the paper's baselines before GLINT, then the others.
wanted_cells() {
  awk -F/ -v records="$1" '
    function of(text, key,   rest) {
      rest = substr(text, index(text, "\"" key "\":") + length(key) + 3)
      sub(/^"/, "", rest); sub(/["},].*/, "", rest); return rest
    }
    BEGIN {
      while ((getline line < records) > 0)
        if (line ~ /"status":"ok"/) done[of(line, "scene") "/" of(line, "method") "/" of(line, "seed")] = 1
      n = split("2dgs pgsr ref-gs envgs tsgs glint glint/plus rt-splatting 2dgs/prior", order, " ")
      for (i = 1; i <= n; ++i) rank[order[i]] = i <= 5 ? 1 : i <= 7 ? 2 : 3
    }
    !($0 in done) {
      method = $0; sub(/^[^\/]*\//, "", method); sub(/\/[^\/]*$/, "", method)
      print $NF, (method in rank ? rank[method] : 4), NR, $0
    }' | sort -k1,1n -k2,2n -k3,3n | cut -d' ' -f4-
}

[ -z "$evidence" ] || pack_evidence

cat >$bundle/BUNDLE.md <<ABOUT
Commit $(git describe --always --dirty), CUDA architectures $arch, needs ${glibc/_/ } or newer.
ABOUT

find $bundle -type f -printf '%10s  %P\n' | sort -rn
total=$(used)
awk -v all="$total" -v t="$tree" 'BEGIN { m = 1048576; printf "%.1f MiB, with the tracked files %.1f of 58\n", (all - t) / m, all / m }'
cat $bundle/BUNDLE.md
[ -z "$evidence" ] || echo "$(wc -l <$bundle/cells.txt) cells in ${packed[*]}"
if [ "$total" -gt $limit ]; then
  echo "bundle: more than 58 MiB; give a smaller scene (fewer views, dataset pack --max-pixels), or --without-tests" >&2
  exit 4
fi
