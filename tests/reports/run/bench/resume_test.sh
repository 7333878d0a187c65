#!/usr/bin/env bash
# Trainings that are killed with -9 at random points go on and end with the bytes of ones that were not:
#   resume_test.sh GLINT_BENCH [kills (24) [seed (1)]]
# One method of each family, in turns; half of the trainings are killed again while they go on.
set -euo pipefail
bench=$1 kills=${2:-24}
RANDOM=${3:-1}
methods=(2dgs envgs glint glint/release pgsr ref-gs rt-splatting tsgs)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# train RUN METHOD
train() {
  exec "$bench" train --quiet --device cpu --dataset "$folder/room" --method "$2" --iterations 40 \
    --checkpoint-seconds 0 --run "$1" >"$folder/out" 2>"$folder/err"
}
# What a run folder holds, but for times: files that were trained, and that nothing else was left.
content() { (cd "$1" && find . -type f ! -name env.json ! -name log.jsonl ! -name progress.json ! -path './keys/*' -exec sha256sum {} + | sort -k 2); }
# A checkpoint goes last.
has_ended() { [ -f "$1/keys/train.json" ] && [ ! -f "$1/checkpoint/state.safetensors" ]; }
now_ms() { echo $((${EPOCHREALTIME/[.,]/} / 1000)); }

"$bench" dataset make glassroom --quiet --width 64 --height 36 --views 8 --spp 2 --out "$folder/room" >"$folder/out"
declare -A expected took
for method in "${methods[@]}"; do
  begin=$(now_ms)
  (train "$folder/whole" "$method")
  took[$method]=$(($(now_ms) - begin))
  expected[$method]=$(content "$folder/whole")
  rm -rf "$folder/whole"
done

done_kills=0 resumed=0 wrong=0
while [ "$done_kills" -lt "$kills" ]; do
  for method in "${methods[@]}"; do
    [ "$done_kills" -lt "$kills" ] || break
    run=$folder/run
    while :; do
      (train "$run" "$method") &
      pid=$!
      sleep "$(awk -v ms="$((RANDOM % took[$method]))" 'BEGIN { print ms / 1000 }')"
      kill -9 "$pid" 2>/dev/null || true
      wait "$pid" 2>/dev/null || true
      ! has_ended "$run" || break
      done_kills=$((done_kills + 1))
      [ ! -f "$run/checkpoint/state.safetensors" ] || resumed=$((resumed + 1))
      [ $((RANDOM % 2)) -eq 0 ] || break
    done
    has_ended "$run" || (train "$run" "$method") || { cat "$folder/err" >&2; wrong=$((wrong + 1)); }
    if [ "$(content "$run")" != "${expected[$method]}" ]; then
      echo "$method: other files than without a kill:" >&2
      diff <(content "$run") <(echo "${expected[$method]}") >&2 || true
      wrong=$((wrong + 1))
    fi
    rm -rf "$run"
  done
done
echo "$done_kills kills, $resumed of them behind a checkpoint; $wrong trainings ended differently"
[ "$wrong" -eq 0 ] && [ "$resumed" -gt 0 ]
