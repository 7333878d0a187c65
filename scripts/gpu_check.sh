#!/usr/bin/env bash
# Checks and times everything that needs a GPU, on a bare machine without network, from the folder that
# scripts/bundle.sh makes:
#   ./gpu_check.sh [--device cuda|cpu] [--iterations N] [steps...]     steps: machine tests sanitizer perf train
# Writes summary.md, log.txt, perf.json, steps-*.json and evals.json to $OUT (default ./gpu_out). A step that fails or takes
# too long does not stop the others. Exit 4 when one failed. --device cpu rehearses all this without a GPU.
set -uo pipefail

device=cuda
iterations=200  # enough for the devices to differ, if they do
steps=()
while [ $# -gt 0 ]; do
  case $1 in
    --device) device=$2; shift 2 ;;
    --iterations) iterations=$2; shift 2 ;;
    machine | tests | sanitizer | perf | train) steps+=("$1"); shift ;;
    *) echo "gpu_check: unknown argument $1; expected --device, --iterations or a step" >&2; exit 1 ;;
  esac
done
[ ${#steps[@]} -gt 0 ] || steps=(machine tests sanitizer perf train)

out=${OUT:-$PWD/gpu_out}
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$(dirname "$0")" || exit 6
[ -x bin/glint-bench ] || { echo "gpu_check: $PWD/bin/glint-bench is missing; run scripts/bundle.sh first" >&2; exit 6; }
# shellcheck source=/dev/null
source ./environment.sh
PATH=$PWD/bin:$PATH:/usr/local/cuda/bin
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
summary=$out/summary.md log=$out/log.txt
: >"$log"
failed=0

wanted() { [[ " ${steps[*]} " == *" $1 "* ]]; }
row() { printf '| %s | %s | %s |\n' "$1" "$2" "$3" | tee -a "$summary" >&2; }
fail() { row "$1" "**failed**: $2" "${3:-}"; failed=$((failed + 1)); }
skip() { row "$1" "not done: $2" ""; }

# check NAME SECONDS COMMAND...: one row of the summary; output to the log and to $work/last.
check() {
  local name=$1 limit=$2 code=0 start=$EPOCHREALTIME seconds
  shift 2
  timeout --kill-after=10 "$limit" "$@" >"$work/last" 2>"$work/errors" || code=$?
  seconds=$(awk -v a="$start" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.1f s", b - a }')
  { echo "== $name: $*"; cat "$work/last" "$work/errors"; echo "== exit code $code, $seconds"; echo; } >>"$log"
  case $code in
    0) row "$name" ok "$seconds" ;;
    124 | 137) fail "$name" "not done after $limit s" "$seconds" ;;
    *) fail "$name" "exit code $code: $(tail -n 1 "$work/errors")" "$seconds" ;;
  esac
  return $code
}

step_machine() {
  if command -v nvidia-smi >/dev/null; then check nvidia-smi 30 nvidia-smi
  elif [ "$device" = cuda ]; then fail nvidia-smi "not found: no NVIDIA driver here"
  else skip nvidia-smi "not found"; fi
  check "doctor" 30 glint-bench doctor
}

step_tests() {
  local program found=0
  for program in bin/test_*; do
    [ -x "$program" ] || continue
    found=1
    check "$(basename "$program")" 120 "$program"
  done
  [ $found = 1 ] || skip tests "the bundle has none"
}

step_sanitizer() {
  command -v compute-sanitizer >/dev/null || { skip compute-sanitizer "neither here nor in the bundle"; return; }
  local tool program
  for tool in memcheck racecheck; do
    for program in bin/test_*; do
      [ -x "$program" ] || continue
      check "$tool $(basename "$program")" 240 compute-sanitizer --tool "$tool" --error-exitcode 1 "$program"
    done
  done
}

step_perf() {
  if check "perf, $device" 300 glint-bench perf --device "$device" --json; then cp "$work/last" "$out/perf.json"; fi
  local size surfels sizes=(240x135 480x270 960x540) counts=(20000 100000 500000)
  [ "$device" = cuda ] || sizes=(240x135) counts=(20000)
  for size in "${sizes[@]}"; do
    for surfels in "${counts[@]}"; do
      if check "steps, $size, $surfels surfels a set" 150 glint-bench perf --device "$device" --width "${size%x*}" \
        --height "${size#*x}" --surfels "$surfels" --op '*training step' --runs 9 --json; then
        cp "$work/last" "$out/steps-$size-$surfels.json"
      fi
    done
  done
}

# The metric of the last `eval --json`.
metric() { sed -n "s/^ *\"$1\": \([-0-9.e+]*\),*$/\1/p" "$work/last" | head -n 1; }

# train_and_score METHOD DEVICE: prints the PSNR on success.
train_and_score() {
  local run=$work/$1-$2 name="$1, $2"
  check "train $name" 240 glint-bench train --quiet --dataset scene.safetensors --method "$1" --device "$2" \
    --iterations "$iterations" --run "$run" || return
  check "render $name" 120 glint-bench render --quiet --device "$2" --run "$run" || return
  check "eval $name" 60 glint-bench eval --json --run "$run" --out "$work" || return
  { echo "{\"method\": \"$1\", \"device\": \"$2\", \"iterations\": $iterations, \"eval\":"; cat "$work/last"; echo "}"; } \
    >>"$out/evals.json"
  metric psnr >"$work/psnr-$1-$2"
  row "PSNR $name" "$(printf '%.3f' "$(cat "$work/psnr-$1-$2")") dB" ""
}

step_train() {
  local method on devices=("$device")
  [ "$device" = cpu ] || devices+=(cpu)
  : >"$out/evals.json"
  for method in 2dgs envgs glint; do
    for on in "${devices[@]}"; do train_and_score "$method" "$on"; done
    if [ ! -s "$work/psnr-$method-cuda" ] || [ ! -s "$work/psnr-$method-cpu" ]; then continue; fi
    local difference
    difference=$(paste "$work/psnr-$method-cuda" "$work/psnr-$method-cpu" | awk '{ d = $1 - $2; printf "%.3f", d < 0 ? -d : d }')
    if awk -v d="$difference" 'BEGIN { exit !(d <= 0.1) }'; then row "$method on both devices" ok "$difference dB apart"
    else fail "$method on both devices" "more than 0.1 dB apart" "$difference dB"; fi
  done
}

{ echo "# GPU check"; echo
  echo "$(date -u +%Y-%m-%dT%H:%M:%SZ), --device $device, $iterations iterations, steps: ${steps[*]}"; echo
  [ -f BUNDLE.md ] && { cat BUNDLE.md; echo; }
  echo "| step | result | |"; echo "|---|---|---|"; } >"$summary"
for step in machine tests sanitizer perf train; do
  if wanted "$step"; then "step_$step"; fi
done
{ echo; echo "$failed failed"; } >>"$summary"
echo "gpu_check: $failed failed; see $summary" >&2
[ "$failed" -eq 0 ] || exit 4
