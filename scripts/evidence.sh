#!/usr/bin/env bash
# Cells of a profile until the time is over; the record of each goes to docs/results/PROFILE.jsonl, and cells that stand there are not
# run again. So days of work are done in pieces, on one machine after the other:
#   scripts/evidence.sh [--profile NAME (small)] [--minutes N (60)] [--jobs N (all cores)] [--records FILE] [--work DIR (out/evidence)]
#     [--bench GLINT_BENCH] [--keep] [options of `glint-bench all`, as --methods 2dgs,glint]
# Scene by scene, so that a machine makes few of them, and seed by seed within. A cell that began before the time was over is finished.
# Surfels, renders and meshes go when the cell is recorded; --keep leaves them, for `glint-bench figures`. Failed cells are recorded, too, and
# tried again by the next call. Exit 5: some failed.
set -euo pipefail
cd "$(dirname "$0")/.."

profile=small minutes=60 jobs=$(nproc) records= work=out/evidence bench=build/release/bin/glint-bench keep_runs= options=()
while [ $# -gt 0 ]; do
  case $1 in
    --profile) profile=$2; shift 2 ;;
    --minutes) minutes=$2; shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    --records) records=$2; shift 2 ;;
    --work) work=$2; shift 2 ;;
    --bench) bench=$2; shift 2 ;;
    --keep) keep_runs=1; shift ;;
    *) options+=("$1"); shift ;;
  esac
done
name=$(basename "$profile" .toml)
records=${records:-docs/results/$name.jsonl}
mkdir -p "$work" "$(dirname "$records")"
touch "$records"
work=$(readlink -f "$work")
# Not what is built meanwhile; lib/ has the module that makes the meshes.
rm -rf "$work/bin" "$work/lib"
mkdir -p "$work/bin" "$work/lib"
cp "$bench" "$work/bin/"
cp "$(dirname "$bench")"/../lib/*.so "$work/lib/" || { echo "no meshes without $(dirname "$bench")/../lib: build with Open3D" >&2; exit 6; }
bench=$work/bin/glint-bench
common=(--profile "$profile" --out "$work/out" --data "$work/data")

# has FILE CELL [TEXT]: FILE has a record of scene/method/seed, with TEXT.
has() {
  local scene=${2%%/*} rest=${2#*/}
  grep -F "\"scene\":\"$scene\",\"method\":\"${rest%/*}\",\"seed\":${rest##*/}," "$1" 2>/dev/null | grep -qF -- "${3:-}"
}
# Cells to do, scene by scene and seed by seed, otherwise in the profile's order.
pending() {
  "$bench" status --tasks "${common[@]}" "${options[@]}" --quiet |
    awk -F/ '{ print $1, $NF, NR, $0 }' | sort -k1,1 -k2,2n -k3,3n | cut -d' ' -f4- |
    while read -r cell; do has "$records" "$cell" '"status":"ok"' || echo "$cell"; done
}
# The cell's last record, behind those that are there.
keep() {
  local scene=${1%%/*} rest=${1#*/}
  { cat "$records"
    grep -F "\"scene\":\"$scene\",\"method\":\"${rest%/*}\",\"seed\":${rest##*/}," "$work/out/$name/records.jsonl" | tail -n 1; } >"$records.new"
  mv "$records.new" "$records"
  [ -n "$keep_runs" ] || rm -rf "$work/out/$name/runs/$1"
}

end=$((SECONDS + 60 * minutes)) failed=0
mapfile -t cells < <(pending)
echo "${#cells[@]} cells to do"
for ((i = 0; i < ${#cells[@]} && SECONDS < end; i += jobs)); do
  batch=("${cells[@]:i:jobs}")
  names=()
  for cell in "${batch[@]}"; do names+=(--cell "$cell"); done
  rm -f "$work/out/$name/records.jsonl"
  "$bench" all --no-tables "${common[@]}" "${options[@]}" "${names[@]}" --jobs "$jobs" --quiet || failed=5
  for cell in "${batch[@]}"; do
    has "$work/out/$name/records.jsonl" "$cell" || { echo "$cell: no record" >&2; failed=5; continue; }
    keep "$cell"
  done
  echo "$((i + ${#batch[@]} < ${#cells[@]} ? i + ${#batch[@]} : ${#cells[@]})) of ${#cells[@]}, $((SECONDS / 60)) min: ${batch[*]}"
done
exit "$failed"
