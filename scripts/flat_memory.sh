#!/usr/bin/env bash
# Does memory grow from cell to cell? Runs CELLS smoke cells (all methods, many seeds) in one process (--executor
# inline), and as many in processes of their own, and looks at the resident memory of the process that stays.
#   scripts/flat_memory.sh [--cells N (140)] [--records FILE] [GLINT_BENCH]
# A JSON line for each goes to FILE (docs/results/memory.jsonl): MiB after each cell, and the medians of the second
# and of the last quarter. The first quarter counts for nothing: libraries and allocators fill their caches.
# Exit 4: the last quarter lies more than 5 % and 2 MiB above the second.
set -euo pipefail
cd "$(dirname "$0")/.."

cells=140 records=docs/results/memory.jsonl bench=build/release/bin/glint-bench
while [ $# -gt 0 ]; do
  case $1 in
    --cells) cells=$2; shift 2 ;;
    --records) records=$2; shift 2 ;;
    *) bench=$1; shift ;;
  esac
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$bench" "$work/glint-bench"  # not what is built meanwhile
bench=$work/glint-bench
commit=$("$bench" --version | sed 's/.*(\(.*\)).*/\1/')
methods='"2dgs", "envgs", "glint", "glint/release", "pgsr", "ref-gs", "tsgs"'
sed -e 's/^name.*//' -e "s|^methods = .*|methods = [$methods]|" -e 's/^iterations = .*/iterations = 30/' \
  -e "s/^seeds = .*/seeds = [$(seq -s, 0 $(((cells + 6) / 7 - 1)))]/" reports/profiles/smoke.toml >"$work/flat.toml"

median() { sort -n | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

# all EXECUTOR: resident MiB of the process after each cell, a line each.
all() {
  local list=$work/$1/out/flat/records.jsonl before=0 now
  "$bench" all --profile "$work/flat.toml" --executor "$1" --device cpu --threads 1 --data "$work/data" \
    --out "$work/$1/out" --quiet >"$work/$1.txt" 2>&1 &
  local id=$!
  while kill -0 $id 2>/dev/null; do
    now=$({ cat "$list" 2>/dev/null || true; } | wc -l)
    if [ "$now" -gt "$before" ]; then
      awk '/^VmRSS/ { printf "%.1f\n", $2 / 1024 }' /proc/$id/status 2>/dev/null || true
      before=$now
    fi
    sleep 0.02
  done
  wait $id || { tail -n 3 "$work/$1.txt" >&2; return 4; }
}

grown=0
for executor in inline local; do
  all $executor >"$work/rss.txt"
  count=$(wc -l <"$work/rss.txt")
  quarter=$((count / 4))
  second=$(sed -n "$((quarter + 1)),$((2 * quarter))p" "$work/rss.txt" | median)
  last=$(tail -n $quarter "$work/rss.txt" | median)
  printf '{"executor":"%s","cells":%d,"second_quarter_mib":%s,"last_quarter_mib":%s,"commit":"%s","mib":[%s]}\n' \
    $executor "$count" "$second" "$last" "$commit" "$(paste -sd, "$work/rss.txt")" >>"$records"
  echo "$executor: $count cells, $second MiB in the second quarter, $last MiB in the last"
  awk -v a="$second" -v b="$last" 'BEGIN { exit !(b > 1.05 * a && b > a + 2) }' && grown=4
done
exit $grown
