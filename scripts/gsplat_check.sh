#!/usr/bin/env bash
# Builds gsplat's 2DGS and times it beside ours on the same card, surfels and camera, from the folder that
# `scripts/bundle.sh --gsplat ARCHIVE` makes:
#   ./gsplat_check.sh [--seconds N] [--dry-run] [--folder FOLDER [--build]]
# Needs what a bundle cannot carry: PyTorch with CUDA, rich, ninja, and nvcc of the same major version. Done
# within N seconds (570), the compiler gets 420 of them. To $OUT (default ./gpu_out): gsplat.md, gsplat.log and
# gsplat.tar.gz. --dry-run stops before the compiler. --folder keeps what is compiled, so that the next call finds
# it; with --build nothing else is done. Exit 6: something needed is not here, and which.
set -uo pipefail

seconds=570 dry='' folder='' build=''
while [ $# -gt 0 ]; do
  case $1 in
    --seconds) seconds=$2; shift 2 ;;
    --dry-run) dry=1; shift ;;
    --folder) folder=$2; shift 2 ;;
    --build) build=1; shift ;;
    *) echo "gsplat_check: unknown argument $1; expected --seconds, --dry-run, --folder or --build" >&2; exit 1 ;;
  esac
done
out=${OUT:-$PWD/gpu_out}
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$(dirname "$0")" || exit 6
PATH=$PWD/bin:$PATH:/usr/local/cuda/bin
log=$out/gsplat.log table=$out/gsplat.md
: >"$log"

missing() { echo "gsplat_check: $1" | tee -a "$log" >&2; exit 6; }
archive=$(find gsplat -name '*.tar.*' ! -name glm.tar.xz 2>/dev/null | head -n 1)
[ -n "$archive" ] || missing "gsplat's source is not in the bundle; make it with scripts/bundle.sh --gsplat ARCHIVE"
[ -f gsplat/glm.tar.xz ] || missing "gsplat/glm.tar.xz is not in the bundle (scripts/bundle.sh --gsplat)"
command -v nvcc >/dev/null || missing "no nvcc: gsplat's kernels are compiled where they run"
command -v ninja >/dev/null || missing "no ninja, which PyTorch compiles extensions with"
command -v python3 >/dev/null || missing "no python3"
python3 -c 'import numpy, rich, torch' 2>>"$log" || missing "python3 lacks numpy, rich or torch; gsplat is an extension of PyTorch"
[ -n "$dry" ] || python3 -c 'import sys, torch; sys.exit(not torch.cuda.is_available())' || missing "PyTorch sees no CUDA device"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
folder=${folder:-$work/gsplat}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
source=$folder/source
glm=$source/gsplat/cuda/csrc/third_party/glm
unpack() {
  rm -rf "$source"
  mkdir "$source"
  tar -xf "$archive" -C "$source" --strip-components=1 || missing "cannot unpack $archive"
  # What gsplat calls glm is a checkout of it, with the headers in a folder of the same name.
  mkdir -p "$glm.part"
  tar -xf gsplat/glm.tar.xz -C "$glm.part" || missing "cannot unpack glm"
  [ -f "$glm.part/glm/glm.hpp" ] || missing "glm.tar.xz has no glm/glm.hpp"
  rm -rf "$glm"
  mv "$glm.part" "$glm"
}
[ -f "$glm/glm/glm.hpp" ] || unpack

# Only 2DGS, of three colours and with depth as a fourth.
export BUILD_2DGS=1 BUILD_3DGS=0 BUILD_3DGUT=0 BUILD_ADAM=0 BUILD_RELOC=0 BUILD_LOSSES=0 NUM_CHANNELS=3,4
export PYTHONPATH=$source TORCH_EXTENSIONS_DIR=$folder/extensions MAX_JOBS=${MAX_JOBS:-$(nproc)} PYTHONUNBUFFERED=1
[ -n "$dry" ] && { echo "gsplat_check: all that is needed is here" >&2; exit 0; }
TORCH_CUDA_ARCH_LIST=$(python3 -c 'import torch; print("%d.%d" % torch.cuda.get_device_capability())')
export TORCH_CUDA_ARCH_LIST

pack() { tar -czf "$out/gsplat.tar.gz" -C "$out" gsplat.md gsplat.log; }
left() { echo $((seconds - SECONDS - 5)); }
build_limit=$((seconds * 420 / 570))
{ echo "# gsplat's 2DGS beside ours"; echo; echo "$(date -u +%Y-%m-%dT%H:%M:%SZ), $(basename "$archive")"; } >"$table"
echo "gsplat_check: compiling gsplat, at most $build_limit s" >&2
timeout --kill-after=5 "$build_limit" python3 -c 'from gsplat.cuda._backend import _C; assert _C' >>"$log" 2>&1 || {
  echo "Not built: see gsplat.log" >>"$table"
  pack
  missing "gsplat could not be built within $build_limit s: $(grep . "$log" | tail -n 1)"
}
echo "Built in $SECONDS s." >>"$table"
[ -z "$build" ] || exit 0
# shellcheck source=/dev/null
source ./environment.sh

value() { sed -n "s/^ *\"$1\": \([-0-9.e+]*\),*$/\1/p" "$work/theirs"; }
ours() { awk -F'"' -v op="$1" '/"op":/ { at = $4 == op } at && /"ms":/ { gsub(/[^-0-9.e+]/, "", $3); print $3 }' "$work/ours"; }
line() { awk -v name="$1" -v a="$2" -v b="$3" 'BEGIN { printf "| %s | %.3f | %.3f | %s |\n", name, a, b, (b > 0 ? sprintf("%.2f", a / b) : "-") }' | tee -a "$table" >&2; }
compare() {
  local size=(--width "$1" --height "$2" --surfels "$3")
  [ "$(left)" -ge 10 ] || { echo "gsplat_check: no time left for $*" | tee -a "$log" >&2; return 1; }
  rm -rf "$work/scene"
  { glint-bench perf --device cpu "${size[@]}" --write-scene "$work/scene" &&
    timeout "$(left)" python3 gsplat_times.py "$work/scene" 31 >"$work/theirs" &&
    timeout "$(left)" glint-bench perf --quiet --device cuda --json --runs 31 "${size[@]}" \
      --op 'activate, SH, rasterize*|2dgs training step' >"$work/ours"; } 2>>"$log" || return 1
  cat "$work/theirs" "$work/ours" >>"$log"
  { echo; echo "$1x$2, $3 surfels"; echo; echo "| ms | gsplat | ours | ratio |"; echo "|---|---:|---:|---:|"; } >>"$table"
  line "forward, with activation and SH" "$(value forward_ms)" "$(ours 'activate, SH, rasterize')"
  line "forward + backward, to the raw parameters" "$(value forward_backward_ms)" "$(ours 'activate, SH, rasterize + backward')"
  line "step (gsplat: L1, Adam)" "$(value step_l1_ms)" "$(ours '2dgs training step')"
  line "step (gsplat: L1 + SSIM, Adam; ours: the method's whole step)" "$(value step_l1_ssim_ms)" "$(ours '2dgs training step')"
  pack
}
failed=0
for size in "480 270" "960 540"; do
  for surfels in 100000 500000; do
    # shellcheck disable=SC2086
    compare $size $surfels || { failed=1; tail -n 3 "$log" >&2; }
  done
done
pack
cat "$table"
[ $failed = 0 ] || exit 4
