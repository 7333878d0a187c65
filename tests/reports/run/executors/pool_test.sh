#!/usr/bin/env bash
# `all` with a process for each cell, stopped by SIGTERM and by kill -9: no process of it is left, checkpoints are,
# and in the end the surfels are those of cells that ran in one process; reports at the same time: pool_test.sh GLINT_BENCH
set -euo pipefail
bench=$(readlink -f "$1")
folder=$(mktemp -d /tmp/glint_pool.XXXXXX)
trap 'rm -rf "$folder"' EXIT
fail() { echo "FAILED: $*" >&2; cat "$folder"/*.err >&2; exit 1; }

common=(--profile smoke --methods 2dgs,envgs,glint --iterations 160 --device cpu --data "$folder/data" --quiet)
workers() { pgrep -f -- "all --no-tables --executor inline .*--out $folder/pool " || true; }
no_worker_within() {  # SECONDS
  for _ in $(seq $(($1 * 10))); do [ -n "$(workers)" ] || return 0; sleep 0.1; done
  return 1
}
start() {  # FILE CHECKPOINT_SECONDS: until a run has the file
  "$bench" all "${common[@]}" --out "$folder/pool" --jobs 2 --checkpoint-seconds "$2" >"$folder/out" 2>"$folder/pool.err" &
  pool=$!
  for _ in $(seq 300); do
    ls "$folder"/pool/smoke/runs/room_1/*/0/"$1" >/dev/null 2>&1 && [ -n "$(workers)" ] && return
    sleep 0.1
  done
  fail "no $1 within 30 s"
}

"$bench" all "${common[@]}" --out "$folder/inline" --executor inline >"$folder/out" 2>"$folder/inline.err"

start log.jsonl 1000  # so that a checkpoint is the signal's
kill -TERM "$pool"
code=0; wait "$pool" || code=$?
[ "$code" -eq 143 ] || fail "SIGTERM: exit $code, not 143"
no_worker_within 1 || fail "SIGTERM: workers are left"
ls "$folder"/pool/smoke/runs/room_1/*/0/checkpoint/state.safetensors >/dev/null || fail "SIGTERM: no checkpoint"

start checkpoint/state.safetensors 0.2
kill -9 "$pool"
wait "$pool" 2>/dev/null || true

# At once: its workers, which were told to end, are waited for.
code=0; "$bench" all "${common[@]}" --out "$folder/pool" --jobs 2 >"$folder/out" 2>"$folder/pool.err" || code=$?
[ "$code" -eq 0 ] || fail "right after kill -9: exit $code"
no_worker_within 1 || fail "kill -9: workers are left"
content() { (cd "$1/smoke/runs" && find . -name '*.ply' -not -name 'mesh*' -exec sha256sum {} + | sort -k 2); }
[ "$(content "$folder/inline" | wc -l)" -ge 5 ] || fail "too few surfel files"
diff <(content "$folder/inline") <(content "$folder/pool") || fail "other surfels than in one process"
"$bench" compare "$folder/inline/smoke" "$folder/pool/smoke" --tolerance 0 --quiet >"$folder/compare.err" || fail "other scores"

# Each of two `all`s on one folder writes the page at its end.
for try in 1 2 3; do
  ids=()
  for one in 1 2 3; do
    "$bench" report --profile smoke --out "$folder/pool" --data "$folder/data" --quiet >"$folder/report_$one.err" 2>&1 & ids+=($!)
  done
  for id in "${ids[@]}"; do wait "$id" || fail "three reports at once, try $try"; done
  left=$(ls -A "$folder/pool/smoke/report")
  [ "$left" = $'assets\nindex.html' ] || fail "three reports left $left"
done
echo "stopped twice, ended with the same surfels and scores"
