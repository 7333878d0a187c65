#!/usr/bin/env bash
# Smoke cells again and again, disturbed each time: workers and whole runs killed at random times, two runs at once, a full disk, a
# folder that becomes read-only, a clock that jumps. After each disturbance the same command has to end with exit
# code 0 and the surfels of an undisturbed run; nothing may be left over, and no record torn.
#   scripts/endurance.sh [--seconds N (7200)] [--records FILE] [GLINT_BENCH]
# One JSON line a round goes to FILE (docs/results/endurance.jsonl); what it holds already counts towards N, so the
# work may be done in pieces. Root (for tmpfs); libfaketime for the clock, else that round is left out.
# Exit 4: something was lost.
set -eEuo pipefail
cd "$(dirname "$0")/.."

seconds=7200 records=docs/results/endurance.jsonl bench=build/release/bin/glint-bench
while [ $# -gt 0 ]; do
  case $1 in
    --seconds) seconds=$2; shift 2 ;;
    --records) records=$2; shift 2 ;;
    *) bench=$1; shift ;;
  esac
done
[ "$(id -u)" -eq 0 ] || { echo "endurance: tmpfs wants root" >&2; exit 6; }
work=$(mktemp -d)
disk=$work/disk
mkdir "$disk"
cleanup() { mountpoint -q "$disk" && umount -l "$disk"; rm -rf "$work"; }
trap cleanup EXIT
trap 'echo "endurance: line $LINENO failed: $BASH_COMMAND" >&2' ERR
cp "$bench" "$work/glint-bench"  # not what is built meanwhile
bench=$work/glint-bench
commit=$("$bench" --version | sed 's/.*(\(.*\)).*/\1/')
methods=(2dgs envgs glint glint/release pgsr ref-gs tsgs)
faketime=$(find /usr/lib -name libfaketimeMT.so.1 2>/dev/null | head -n 1)

done_seconds() { [ -f "$records" ] && awk -F'"seconds":' '{ split($2, s, ","); sum += s[1] } END { printf "%d", sum }' "$records" || echo 0; }
done_rounds() { [ -f "$records" ] && wc -l <"$records" || echo 0; }

words=(all --profile smoke --iterations 40 --device cpu --threads 1 --data "$work/data" --out "$disk/out"
  --checkpoint-seconds 0.1 --quiet)
# all METHOD: one cell on the tmpfs.
all() {
  "$bench" "${words[@]}" --only "room_1/$1/0" --methods "$1" >"$work/out.txt" 2>"$work/err.txt"
}
surfels() { (cd "$disk/out/smoke/runs/room_1/$1/0" && find . -maxdepth 1 -name '*.ply' -not -name 'mesh*' -exec sha256sum {} + | sort); }
mount_disk() { mount -t tmpfs -o "size=$1" tmpfs "$disk"; }
random() { echo $((RANDOM % $1)); }
pause() { sleep "$(awk -v ms="$(random "$1")" 'BEGIN { print ms / 1000 }')"; }

# What an undisturbed run takes and gives, of each method.
declare -A expected took
undisturbed() {
  [ -z "${expected[$1]:-}" ] || return 0
  local begin=${EPOCHREALTIME/[.,]/}
  mount_disk 200m
  all "$1"
  took[$1]=$(((${EPOCHREALTIME/[.,]/} - begin) / 1000))
  expected[$1]=$(surfels "$1")
  umount "$disk"
}

# A run that is disturbed from outside: `run` is its process, which no function stands in front of.
start() {
  "$bench" "${words[@]}" --only "room_1/$1/0" --methods "$1" >"$work/out.txt" 2>"$work/err.txt" &
  run=$!
}
# Those whose starter was killed end after their step; until then their cells are theirs.
no_workers() { for _ in $(seq 600); do pgrep -f "all --no-tables --executor inline .*--out $disk/out" >/dev/null || return 0; sleep 0.1; done; }
killed_run() { start "$1"; pause "${took[$1]}"; kill -9 $run 2>/dev/null || true; wait $run 2>/dev/null || true; no_workers; }
# Killed while another one has begun on the same folder: they share its cell, or one waits.
two_runs() {
  start "$1"; local first=$run
  pause "${took[$1]}"
  "$bench" "${words[@]}" --only "room_1/$1/0" --methods "$1" >"$work/second.txt" 2>&1 & local second=$!
  wait $first 2>/dev/null || true
  wait $second || true
}
killed_worker() {
  start "$1"
  pause "${took[$1]}"
  pkill -9 -f "all --no-tables --executor inline .*--out $disk/out" || true
  wait $run 2>/dev/null || true
}
told_to_stop() { start "$1"; pause "${took[$1]}"; kill -TERM $run 2>/dev/null || true; wait $run 2>/dev/null || true; }
full_disk() {
  mount -o "remount,size=$((100 + $(random 4000)))k" "$disk" 2>/dev/null || return 0
  all "$1" || true
  mount -o remount,size=200m "$disk"
}
read_only() {
  start "$1"
  pause "${took[$1]}"
  mount -o remount,ro "$disk" 2>/dev/null || true
  wait $run 2>/dev/null || true
  mount -o remount,rw "$disk"
}
# Only the clock of the calendar: the other one cannot jump.
clock_jumps() {
  [ -n "$faketime" ] || return 0
  echo "+0" >"$work/clock"
  LD_PRELOAD=$faketime FAKETIME_TIMESTAMP_FILE=$work/clock FAKETIME_NO_CACHE=1 FAKETIME_DONT_FAKE_MONOTONIC=1 all "$1" &
  local id=$!
  for jump in +10y -3d -20y +1h; do pause "$((took[$1] / 3 + 1))"; echo "$jump" >"$work/clock"; done
  wait $id 2>/dev/null || true
}

# Empty: nothing was lost.
what_is_wrong() {
  local code=0
  all "$1" || code=$?
  [ $code -eq 0 ] || { echo "the last run: exit $code: $(tail -n 1 "$work/err.txt")"; return; }
  [ "$(surfels "$1")" = "${expected[$1]}" ] || { echo "other surfels"; return; }
  grep -q "torn record" "$work/err.txt" && { echo "a torn record"; return; }
  local left
  left=$("$bench" status --leftovers --profile smoke --out "$disk/out" --quiet)
  [ "$left" = "nothing is left over" ] || echo "left over: $left"
}

kinds=(killed_run two_runs killed_worker told_to_stop full_disk read_only clock_jumps)
wrong=0
while [ "$(done_seconds)" -lt "$seconds" ]; do
  method=${methods[$(random ${#methods[@]})]} kind=${kinds[$(random ${#kinds[@]})]}
  undisturbed "$method"
  begin=$SECONDS
  mount_disk 200m
  times=$((1 + $(random 3)))
  for _ in $(seq $times); do $kind "$method"; done
  why=$(what_is_wrong "$method")
  why=${why//[$'\n\t\\"']/ }
  cells=$({ cat "$disk/out/smoke/records.jsonl" 2>/dev/null || true; } | wc -l)
  umount "$disk"
  [ -z "$why" ] || { wrong=$((wrong + 1)); cp "$work/err.txt" "build/endurance_$(done_rounds).txt"; }
  printf '{"round":%d,"disturbance":"%s","times":%d,"method":"%s","records":%d,"lost":"%s","seconds":%d,"commit":"%s"}\n' \
    "$(done_rounds)" $kind $times "$method" "$cells" "$why" $((SECONDS - begin)) "$commit" >>"$records"
done
echo "$(done_rounds) rounds in $(done_seconds) s, $wrong of these with something lost"
[ $wrong -eq 0 ] || exit 4
