#!/usr/bin/env bash
# Cells of a profile until the time is over; the record of each goes to docs/results/PROFILE.jsonl, and cells that stand there are not
# run again. So days of work are done in pieces, on one machine after the other:
#   scripts/evidence.sh [--profile NAME (small)] [--minutes N (60)] [--jobs N (all cores)] [--threads N (of a cell; cores / jobs)]
#     [--records FILE] [--work DIR (out/evidence)] [--bench GLINT_BENCH] [--keep] [options of `glint-bench all`, as --methods 2dgs,glint]
# Scene by scene, so that a machine makes few of them, and seed by seed within; a job that is free takes the next. A cell that began before
# the time was over is finished. Surfels, renders and meshes go when the cell is recorded; --keep leaves them, for `glint-bench figures`.
# Failed cells are recorded, too, and tried again by the next call, as what was stopped goes on. Exit 5: some failed.
set -euo pipefail
cd "$(dirname "$0")/.."

profile=small minutes=60 jobs=$(nproc) threads= records= work=out/evidence bench=build/release/bin/glint-bench keep_runs= options=()
while [ $# -gt 0 ]; do
  case $1 in
    --profile) profile=$2; shift 2 ;;
    --minutes) minutes=$2; shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    --threads) threads=$2; shift 2 ;;
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
threads=${threads:-$(($(nproc) > jobs ? $(nproc) / jobs : 1))}
runs=$work/out/$name
end=$(($(date +%s) + 60 * minutes))
export records work bench keep_runs runs end

# last_record FILE CELL: its last line there.
last_record() {
  local scene=${2%%/*} rest=${2#*/}
  grep -F "\"scene\":\"$scene\",\"method\":\"${rest%/*}\",\"seed\":${rest##*/}," "$1" 2>/dev/null | tail -n 1
}
# keep_record CELL: behind those that are there, by one job at a time.
keep_record() {
  local line
  line=$(last_record "$runs/records.jsonl" "$1")
  [ -n "$line" ] || { echo "$1: no record" >&2; return 5; }
  exec 9>"$work/keep.lock"
  flock 9
  if ! grep -qxF -- "$line" "$records"; then { cat "$records"; echo "$line"; } >"$records.new" && mv "$records.new" "$records"; fi
  exec 9>&-
  [ -n "$keep_runs" ] || rm -rf "$runs/runs/$1"
}
# run_cell OPTIONS... CELL
run_cell() {
  local cell=${!#} status=0
  [ "$(date +%s)" -lt "$end" ] || return 0
  "$bench" all --no-tables "$@" || status=5
  keep_record "$cell" || status=5
  echo "$cell, $(((end - $(date +%s)) / 60)) min left"
  return $status
}
export -f last_record keep_record run_cell

# Cells without a record, scene by scene and seed by seed, otherwise in the profile's order. (In an empty --out none is done.)
pending() {
  "$bench" status --tasks --profile "$profile" --out "$work/empty" "${options[@]}" --quiet |
    awk -F/ '{ print $1, $NF, NR, $0 }' | sort -k1,1 -k2,2n -k3,3n | cut -d' ' -f4- |
    while read -r cell; do last_record "$records" "$cell" | grep -qF '"status":"ok"' || echo "$cell"; done
}

mapfile -t cells < <(pending)
echo "${#cells[@]} cells to do"
[ ${#cells[@]} -gt 0 ] || exit 0
printf '%s\n' "${cells[@]}" |
  xargs -P "$jobs" -n 1 bash -c 'run_cell "$@"' run_cell --profile "$profile" --out "$work/out" --data "$work/data" --threads "$threads" \
    "${options[@]}" --quiet --cell || exit 5
