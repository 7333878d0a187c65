#!/usr/bin/env bash
# Everything that a machine with a GPU needs, in build/bundle: the lean glint-bench, its shared libraries (not
# glibc), the GPU tests with and without fused multiply-add, gpu-probe, gpu_check.sh, what ptxas says of each
# kernel, and one packed scene.
#   scripts/bundle.sh [--arch LIST] [--gsplat ARCHIVE] [SCENE_FOLDER_OR_PACKED]
# LIST: CUDA architectures, default 90. ARCHIVE: gsplat's source, for gsplat_check.sh, with the glm that it
# includes (libglm-dev). Without a scene, a small GlassRoom of 480x270 is made. Exit 4 where bundle and tracked
# files are above 58 MiB together.
set -euo pipefail
cd "$(dirname "$0")/.."

arch=90 gsplat='' scene=''
while [ $# -gt 0 ]; do
  case $1 in
    --arch) arch=$2; shift 2 ;;
    --gsplat) gsplat=$2; shift 2 ;;
    -*) echo "bundle: unknown option $1; expected --arch or --gsplat" >&2; exit 1 ;;
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
configure -DGLINT_CUDA_FMAD=OFF
rm -rf $bundle
mkdir -p $bundle/lib/cxx
build gpu_tests
strip_to $bundle/bin/no-fmad $build/tests/gpu_tests
configure -DGLINT_CUDA_FMAD=ON
mapfile -t scale < <(cmake --build $build --target help | grep -ox 'test_glint_cuda_scale: phony' | sed 's/:.*//')
build glint-bench gpu-probe gpu_tests "${scale[@]}"
programs=("$build/bin/glint-bench" "$build/bin/gpu-probe" "$build/tests/gpu_tests" "${scale[@]/#/$build/tests/}")
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
cp scripts/gpu_check.sh scripts/gsplat_check.sh scripts/gsplat_times.py $bundle/

if [ -n "$gsplat" ]; then
  [ -d /usr/include/glm ] || { echo "bundle: gsplat includes glm; install libglm-dev" >&2; exit 6; }
  mkdir $bundle/gsplat
  cp "$gsplat" $bundle/gsplat/
  tar -cJf $bundle/gsplat/glm.tar.xz -C /usr/include glm
fi

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
xz -T0 $bundle/scene.safetensors  # floats of normals and depth: a third of it

tar -cf - -C $bundle bin lib | xz -T0 >$bundle/programs.tar.xz  # a third; environment.sh unpacks them
rm -r $bundle/bin $bundle/lib

cat >$bundle/BUNDLE.md <<ABOUT
Commit $(git describe --always --dirty), CUDA architectures $arch, needs ${glibc/_/ } or newer.
ABOUT

find $bundle -type f -printf '%10s  %P\n' | sort -rn
total=$(find $bundle -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum }')
tree=$(git ls-files -z | xargs -0 stat -c %s 2>/dev/null | awk '{ sum += $1 } END { print sum }')
awk -v b="$total" -v t="$tree" 'BEGIN { m = 1048576; printf "%.1f MiB, with the tracked files %.1f of 58\n", b / m, (b + t) / m }'
cat $bundle/BUNDLE.md
if [ $((total + tree)) -gt $limit ]; then
  echo "bundle: more than 58 MiB; give a smaller scene (fewer views, dataset pack --max-pixels)" >&2
  exit 4
fi
