#!/usr/bin/env bash
# scripts/evidence.sh keeps a record of each cell, and goes on where it was: evidence_test.sh GLINT_BENCH
set -euo pipefail
bench=$(readlink -f "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
evidence() {
  "$(dirname "$0")/../../scripts/evidence.sh" --profile smoke --work "$folder/work" --records "$folder/records.jsonl" --bench "$bench" \
    --jobs 1 --device cpu --iterations 10 --methods "$1" --minutes "$2" ${3:+"$3"}
}
fail() { echo "FAILED: $*" >&2; exit 1; }
lines() { wc -l <"$folder/records.jsonl"; }

evidence 2dgs 0 | grep -q "1 cells to do" || fail "one cell was expected"
[ "$(lines)" -eq 0 ] || fail "no time, and yet a cell was run"
evidence 2dgs 1
[ "$(lines)" -eq 1 ] && grep -q '"status":"ok"' "$folder/records.jsonl" || fail "no record of 2dgs"
[ -z "$(find "$folder/work/out" -name '*.ply')" ] || fail "surfels were left"
cp "$folder/records.jsonl" "$folder/first.jsonl"
rm -rf "$folder/work"  # another machine, which has the records alone
evidence 2dgs,envgs 1
[ "$(lines)" -eq 2 ] && cmp -n "$(stat -c %s "$folder/first.jsonl")" "$folder/first.jsonl" "$folder/records.jsonl" || fail "a cell was run twice, or lost"
evidence 2dgs,envgs 1 | grep -q "^0 cells to do" || fail "there was something left to do"
sed -i 's/"status":"ok"/"status":"failed"/' "$folder/records.jsonl"
evidence 2dgs 0 | grep -q "^1 cells to do" || fail "a failed cell is not tried again"
evidence 2dgs 1 --keep
[ -n "$(find "$folder/work/out" -name '*.ply')" ] || fail "--keep left no surfels"
surfels=$(find "$folder/work/out" -name 'interface.ply' -o -name 'surfels.ply' | head -1)
before=$(stat -c %y "$surfels")
: >"$folder/records.jsonl"  # as if the script had been killed before it kept the record
evidence 2dgs 1 --keep
[ "$(lines)" -eq 1 ] || fail "a finished run was not recorded"
[ "$(stat -c %y "$surfels")" = "$before" ] || fail "a finished run was trained again"
echo "records are kept, and nothing is run twice"
