#!/usr/bin/env bash
# Everything that a machine with a GPU needs, in build/bundle: the lean glint-bench, its shared libraries (not
# glibc), the GPU tests, gpu_check.sh and one packed scene.
#   scripts/bundle.sh [--arch LIST] [SCENE_FOLDER_OR_PACKED]
# LIST: CUDA architectures, default 90. Without a scene, a small GlassRoom is made. Exit 4 above 64 MiB.
set -euo pipefail
cd "$(dirname "$0")/.."

arch=90
scene=
while [ $# -gt 0 ]; do
  case $1 in
    --arch) arch=$2; shift 2 ;;
    -*) echo "bundle: unknown option $1; expected --arch" >&2; exit 1 ;;
    *) scene=$1; shift ;;
  esac
done
limit=$((64 * 1024 * 1024))
bundle=build/bundle
build=build/cuda

mkdir -p build
cmake --preset cuda -DCMAKE_CUDA_ARCHITECTURES="$arch" >build/configure-cuda.log 2>&1 ||
  { cat build/configure-cuda.log >&2; exit 6; }
mapfile -t tests < <(cmake --build $build --target help | grep -o '^test_glint_cuda_[a-z0-9_]*' | sort -u)
cmake --build $build --target glint-bench "${tests[@]}" >&2

rm -rf $bundle
mkdir -p $bundle/bin $bundle/lib $bundle/lib/cxx
programs=("$build/bin/glint-bench" "${tests[@]/#/$build/tests/}")
for program in "${programs[@]}"; do strip -o "$bundle/bin/$(basename "$program")" "$program"; done

# glibc and the driver's own libraries are the other machine's.
ldd "${programs[@]}" | sed -n 's|.* => \(/[^ ]*\) .*|\1|p' | sort -u |
  grep -vE '/(libc|libm|libdl|libpthread|librt|libresolv|ld-linux-x86-64|libcuda|libnvidia-[a-z]*)\.so' |
  while IFS= read -r library; do cp -L "$library" $bundle/lib/; done
# An older glibc may refuse our C++ runtime, but has one of its own that will do.
mv $bundle/lib/libstdc++.so.6 $bundle/lib/libgcc_s.so.1 $bundle/lib/cxx/
glibc=$(objdump -T $bundle/bin/* $bundle/lib/*.so* | grep -o 'GLIBC_2\.[0-9]*' | sort -uV | tail -n 1)

cat >$bundle/environment.sh <<'ENVIRONMENT'
# To be sourced: the bundle's libraries, with its C++ runtime where that runs here.
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export LD_LIBRARY_PATH=$here/lib:$here/lib/cxx${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
"$here/bin/glint-bench" --version >/dev/null 2>&1 || LD_LIBRARY_PATH=${LD_LIBRARY_PATH/":$here/lib/cxx"/}
ENVIRONMENT
cat >$bundle/glint-bench <<'LAUNCHER'
#!/usr/bin/env bash
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"
exec "$here/bin/glint-bench" "$@"
LAUNCHER
chmod +x $bundle/glint-bench
cp scripts/gpu_check.sh $bundle/

if [ -n "$scene" ] && [ -f "$scene" ]; then
  cp "$scene" $bundle/scene.safetensors
else
  scripts/build.sh release glint-bench
  if [ -z "$scene" ]; then
    scene=data/bundle/room_1
    build/release/bin/glint-bench dataset make glassroom --scene room_1 --width 240 --height 135 --views 32 \
      --spp 32 --out $scene >&2
  fi
  build/release/bin/glint-bench dataset pack "$scene" $bundle/scene.safetensors --test-truth-only >&2
fi

echo "Commit $(git describe --always --dirty), CUDA architectures $arch, needs ${glibc/_/ } or newer." \
  >$bundle/BUNDLE.md
$bundle/glint-bench dataset info $bundle/scene.safetensors >&2

find $bundle -type f -printf '%10s  %P\n' | sort -rn
total=$(find $bundle -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum }')
printf '%10d  in all (%.1f of 64 MiB), needs %s\n' "$total" "$(awk "BEGIN { print $total / 1048576 }")" "$glibc"
if [ "$total" -gt $limit ]; then
  echo "bundle: more than 64 MiB; give a smaller scene (fewer views, dataset pack --max-pixels)" >&2
  exit 4
fi
