#!/usr/bin/env bash
# scripts/gsplat_check.sh names what is missing, unpacks what it was given as gsplat wants it, and compares.
set -uo pipefail
scripts=$(cd "$(dirname "$0")/../.." && pwd)/scripts
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0
say() { echo "gsplat_check_test: $1" >&2; failures=$((failures + 1)); }
expect() { "${@:2}" || say "$1"; }

stand_in() { printf '#!/usr/bin/env bash\n%s\n' "$2" >"$folder/bundle/bin/$1"; chmod +x "$folder/bundle/bin/$1"; }
mkdir -p "$folder"/{bundle/bin,source/gsplat-1/gsplat/cuda/csrc/third_party/glm,headers/glm}
cp "$scripts"/gsplat_check.sh "$scripts"/gsplat_times.py "$folder/bundle/"
echo : >"$folder/bundle/environment.sh"
export OUT=$folder/out
run() { "$folder/bundle/gsplat_check.sh" "$@" 2>"$folder/err"; }

run --dry-run
expect "no source: exit 6" [ $? = 6 ]
expect "no source is told" grep -q 'bundle.sh --gsplat' "$folder/err"

mkdir "$folder/bundle/gsplat"
tar -cJf "$folder/bundle/gsplat/gsplat-1.tar.xz" -C "$folder/source" gsplat-1
touch "$folder/headers/glm/glm.hpp"
tar -cJf "$folder/bundle/gsplat/glm.tar.xz" -C "$folder/headers" glm
stand_in nvcc :
stand_in ninja :
stand_in python3 'case $* in *"import numpy"*) exit 1 ;; esac'
run --dry-run
expect "no PyTorch: exit 6" [ $? = 6 ]
expect "no PyTorch is told" grep -q 'lacks numpy, rich or torch' "$folder/err"

# A compiler that finds glm where gsplat includes it, and times of both.
stand_in python3 'case $* in
  *get_device_capability*) echo 9.0 ;;
  *_backend*) [ -f "$PYTHONPATH/gsplat/cuda/csrc/third_party/glm/glm/glm.hpp" ] && [ "$BUILD_2DGS" = 1 ] ;;
  *gsplat_times.py*) printf "  \"%s\": %s,\n" forward_ms 2 forward_backward_ms 6 step_l1_ms 8 step_l1_ssim_ms 9 ;;
esac'
stand_in glint-bench 'case $* in
  *--json*) printf "  \"op\": \"%s\",\n  \"ms\": %s,\n" "activate, SH, rasterize" 1 "activate, SH, rasterize + backward" 3 "2dgs training step" 4 ;;
esac'
run
expect "all there: exit 0" [ $? = 0 ]
expect "ratios are told" grep -qF '| step (gsplat: L1, Adam) | 8.000 | 4.000 | 2.00 |' "$OUT/gsplat.md"
expect "and those of the rasteriser" grep -qF '| forward + backward, to the raw parameters | 6.000 | 3.000 | 2.00 |' "$OUT/gsplat.md"
expect "every size is timed" [ "$(grep -c surfels "$OUT/gsplat.md")" = 4 ]
rm -r "$OUT"
run --folder "$folder/kept" --build
expect "built and no more: exit 0" [ $? = 0 ]
expect "nothing is timed" [ "$(grep -c surfels "$OUT/gsplat.md")" = 0 ]
touch "$folder/kept/source/here"
run --folder "$folder/kept"
expect "what was built is taken" [ -f "$folder/kept/source/here" ]
expect "and timed" [ "$(grep -c surfels "$OUT/gsplat.md")" = 4 ]
expect "an archive" tar -tzf "$OUT/gsplat.tar.gz" >/dev/null

stand_in python3 'case $* in *_backend*) echo "error: no such header"; exit 1 ;; esac'
run
expect "not built: exit 6" [ $? = 6 ]
expect "why it was not built is told" grep -q 'could not be built within .*error: no such header' "$folder/err"

[ $failures = 0 ] || exit 1
