#!/usr/bin/env bash
# Checks and times everything that needs a GPU, on a bare machine without network, from the folder that
# scripts/bundle.sh makes:
#   ./gpu_check.sh [--device cuda|cpu] [--seconds N] [--iterations N] [steps...]
# steps: machine tests scale perf train profile sanitizer, and, where asked for, methods. Done within N seconds (570): each step has its share
# and gets what those before it left. To $OUT (default ./gpu_out), so that a kill loses nothing: summary.md and
# log.txt as they grow, and all files in gpu_check.tar.gz, made anew before every check.
# Exit 4: a check failed; 6: no kernel runs here, nothing else was tried. --device cpu rehearses without a GPU.
set -uo pipefail

all_steps=(machine tests scale perf train methods profile sanitizer)
device=cuda seconds=570 iterations=
steps=()
while [ $# -gt 0 ]; do
  case $1 in
    --device) device=$2; shift 2 ;;
    --seconds) seconds=$2; shift 2 ;;
    --iterations) iterations=$2; shift 2 ;;
    *)
      [[ " ${all_steps[*]} " == *" $1 "* ]] || {
        echo "gpu_check: unknown argument $1; expected --device, --seconds, --iterations or one of ${all_steps[*]}" >&2
        exit 1
      }
      steps+=("$1"); shift ;;
  esac
done
[ ${#steps[@]} -gt 0 ] || steps=(machine tests scale perf train profile sanitizer)

out=${OUT:-$PWD/gpu_out}
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$(dirname "$0")" || exit 6
[ -x bin/glint-bench ] || [ -f programs.tar.xz ] ||
  { echo "gpu_check: neither bin/glint-bench nor programs.tar.xz in $PWD; run scripts/bundle.sh first" >&2; exit 6; }
# shellcheck source=/dev/null
source ./environment.sh
PATH=$PWD/bin:$PATH:/usr/local/cuda/bin
work=$(mktemp -d)
files=$work/gpu_check  # what the archive holds
mkdir "$files"
sampler=
finish() { [ -z "$sampler" ] || kill "$sampler" 2>/dev/null; rm -rf "$work"; }
trap finish EXIT
summary=$out/summary.md log=$out/log.txt
: >"$log"
failed=0 undone=0

# On the CPU all this is slow, and only rehearsed.
if [ "$device" = cuda ]; then
  sizes=(480x270 240x135 960x540) counts=(20000 100000 500000) runs=9 long=${iterations:-2000} short=200
  export GLINT_REQUIRE_GPU=1
else
  sizes=(240x135) counts=(2000) runs=1 long=${iterations:-30} short=10
fi

# Whole seconds until a share of the time, in 570ths, is used up.
until_share() { echo $((seconds * $1 / 570 - SECONDS)); }

wanted() { [[ " ${steps[*]} " == *" $1 "* ]]; }
row() { printf '| %s | %s | %s |\n' "$1" "$2" "$3" | tee -a "$summary" >&2; }
fail() { row "$1" "**failed**: $2" "${3:-}"; failed=$((failed + 1)); }
skip() { row "$1" "not done: $2" ""; undone=$((undone + 1)); }

# Always a whole archive: the new one takes the place of the one before.
pack() {
  cp "$summary" "$log" "$files/"
  tar -czf "$out/gpu_check.tar.gz.part" -C "$work" gpu_check || [ $? = 1 ] || return  # 1: a file grew meanwhile
  mv "$out/gpu_check.tar.gz.part" "$out/gpu_check.tar.gz"
}

# check NAME SECONDS COMMAND...: one row of the summary, within SECONDS and this step's share; output to the log
# as it comes, standard output to $work/last, too.
check() {
  local name=$1 limit=$2 left code start=$EPOCHREALTIME took last_line
  shift 2
  left=$(until_share "$share")
  [ "$left" -ge 2 ] || { skip "$name" "no time left"; return 1; }
  [ "$limit" -le "$left" ] || limit=$left
  pack  # with what was kept since the last check
  echo "== $name: $*" >>"$log"
  timeout --kill-after=3 "$limit" "$@" 2>>"$log" | tee -a "$log" >"$work/last"
  code=${PIPESTATUS[0]}
  last_line=$(grep . "$log" | tail -n 1)
  took=$(awk -v a="$start" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.1f s", b - a }')
  printf '== exit code %s, %s\n\n' "$code" "$took" >>"$log"
  case $code in
    0) row "$name" ok "$took" ;;
    124 | 137)
      if [ "$limit" = "$left" ]; then skip "$name" "stopped after $limit s, no time left"
      else fail "$name" "not done after $limit s" "$took"; fi ;;
    *) fail "$name" "exit code $code: ${last_line:0:300}" "$took" ;;
  esac
  return "$code"
}
keep() { cp "$work/last" "$files/$1"; }

# The numbers of a `--json` file: one key's, or "op value" of each row.
number() { sed -n "s/^ *\"$1\": \([-0-9.e+]*\),*$/\1/p" "$2" | head -n 1; }
times() {
  awk -F'"' '/"op":/ { op = $4 } /"ms":/ { gsub(/[^-0-9.e+]/, "", $3); printf "%s%s %.2f", n++ ? ", " : "", op, $3 }' "$1"
}

step_machine() {
  if command -v nvidia-smi >/dev/null; then
    check nvidia-smi 15 nvidia-smi && keep nvidia-smi.txt
    nvidia-smi --query-gpu=timestamp,clocks.sm,clocks.mem,power.draw,temperature.gpu,memory.used --format=csv -l 2 \
      >"$files/clocks.csv" 2>/dev/null &
    sampler=$!
  elif [ "$device" = cuda ]; then fail nvidia-smi "not found: no NVIDIA driver here"
  else skip nvidia-smi "not found"; fi
  if [ "$device" = cpu ]; then
    skip "a kernel runs" "--device cpu"
    check doctor 15 glint-bench doctor && keep doctor.txt
    return
  fi
  check "a kernel runs" 40 gpu-probe && keep probe.txt && check doctor 15 glint-bench doctor && keep doctor.txt && return
  fail "everything else" "no kernel of ours runs on this machine"
  finish_summary
  exit 6
}

# The largest difference from the CPU in a list, in parts of what is allowed.
tell_differences() {
  [ -f "$1" ] || return
  row "" "$(grep -c . "$1") arrays compared" "$(awk -F'\t' '
    $1 / $2 >= most { most = $1 / $2; where = $5 " in: " $4 ", " $3 }
    END { printf "most: %.3f of the allowed, %s", most, where }' "$1")"
}

# run_tests NAME SECONDS PROGRAM: every difference from the CPU goes to a list.
run_tests() {
  [ -x "$3" ] || { skip "$1" "not in the bundle"; return; }
  local list
  list=$files/differences-$(tr -c 'a-z0-9\n' - <<<"$1").txt
  check "$1" "$2" env GLINT_DIFFERENCES="$list" "$3" -d yes
  tell_differences "$list"
}

step_tests() {
  run_tests "tests of ops" 60 bin/gpu_tests
  run_tests "tests of ops, no fmad" 60 bin/no-fmad/gpu_tests
}

step_scale() { run_tests "parity at scale" 60 bin/test_glint_cuda_scale; }

# perf NAME SECONDS FILE OPTIONS...
perf() {
  local name=$1 limit=$2 file=$3
  shift 3
  check "$name" "$limit" glint-bench perf --quiet --device "$device" --json --runs "$runs" "$@" && keep "$file" &&
    row "" "" "$(times "$files/$file")"
}

step_perf() {
  local size surfels at
  local step='2dgs training step|envgs training step|glint training step|glint step, transmission traced'
  for size in "${sizes[@]}"; do
    for surfels in "${counts[@]}"; do
      at=(--width "${size%x*}" --height "${size#*x}" --surfels "$surfels")
      perf "steps, $size, $surfels surfels a set, ms" 60 "steps-$size-$surfels.json" --op "$step" "${at[@]}"
      [ "$size" = "${sizes[0]}" ] || continue
      check "kernels, $size, $surfels surfels" 60 glint-bench perf --quiet --device "$device" --kernels --json --runs 5 \
        --op 'glint training step|2dgs training step' "${at[@]}" && keep "kernels-$size-$surfels.json"
    done
    [ "$size" = "${sizes[0]}" ] || continue
    perf "ops, $size, ms" 60 ops.json --op 'rasterize*|activate*|trace*|L1*|normal*|Adam*' \
      --width "${size%x*}" --height "${size#*x}" --surfels "${counts[-1]}"
  done
}

# train_and_score METHOD DEVICE ITERATIONS: prints the PSNR on success.
train_and_score() {
  local file=${1//\//+}-$2-$3
  local name="$1, $2, $3 iterations" run=$work/$file score=$files/$file
  check "train $name" 200 glint-bench train --quiet --dataset "$work/scene.safetensors" --method "$1" --device "$2" \
    --iterations "$3" --run "$run" --json || return
  cp "$work/last" "$score-train.json"
  cp "$run/log.jsonl" "$score-log.jsonl"
  check "render $name" 60 glint-bench render --quiet --device "$2" --run "$run" || return
  check "eval $name" 60 glint-bench eval --json --run "$run" --out "$work" || return
  cp "$work/last" "$score-eval.json"
  cp "$(find "$run/renders" -name rgb.png | sort | head -n 1)" "$score.png" 2>/dev/null
  number psnr "$score-eval.json" >"$work/psnr-$file"
  row "PSNR $name" "$(printf '%.3f' "$(cat "$work/psnr-$file")") dB" ""
}

# Of a log.jsonl: a step without densification is the median of the lines between which the number of surfels
# stayed, and what the others took more is densification.
training_split() {
  awk '
    function field(name,   at) { at = index($0, "\"" name "\":"); return substr($0, at + length(name) + 3) + 0 }
    { i = field("iteration"); s = field("seconds"); n = field("num_surfels") }
    NR == 1 { first = n }
    NR > 1 { step[++k] = (s - s0) / (i - i0); length_of[k] = i - i0; changed[k] = n != n0; if (n == n0) still[++m] = step[k] }
    { i0 = i; s0 = s; n0 = n; saving = field("saving_seconds"); if (n > most) most = n
      v = field("void_steps"); if (v > v0) last_void = i; v0 = v }
    END {
      for (a = 2; a <= m; ++a) for (b = a; b > 1 && still[b - 1] > still[b]; --b) { t = still[b]; still[b] = still[b - 1]; still[b - 1] = t }
      median = m ? still[int((m + 1) / 2)] : 0
      for (a = 1; a <= k; ++a) if (changed[a]) more += (step[a] - median) * length_of[a]
      printf "step %.2f ms (median), densification %.2f s, saving %.2f s, of %.2f s; %d to %d surfels, most %d; %d steps left out",
        1000 * median, more, saving, s + saving, first, n, most, v
      print v ? ", the last by iteration " last_void : ""
    }' "$1"
}

# Largest relative difference of the loss in the first ten steps of two log.jsonl. Later ones say less: each
# step makes differences of rounding larger, as it does those of a seed.
first_losses_apart() {
  paste <(head -n 10 "$1" | sed 's/.*"loss":\([-0-9.e+]*\).*/\1/') <(head -n 10 "$2" | sed 's/.*"loss":\([-0-9.e+]*\).*/\1/') |
    awk '{ d = ($1 - $2) / $2; if (d < 0) d = -d; if (d > most) most = d } END { printf "%.1e", NR ? most : 1 }'
}
compare_devices() {
  local a=$files/$1-cuda-$short b=$files/$1-cpu-$short apart
  [ -s "$a-log.jsonl" ] && [ -s "$b-log.jsonl" ] || return
  apart=$(first_losses_apart "$a-log.jsonl" "$b-log.jsonl")
  if awk -v d="$apart" 'BEGIN { exit !(d <= 1e-5) }'; then row "$1 on both devices" ok "losses of ten steps $apart apart"
  else fail "$1 on both devices" "losses of the first ten steps more than 1e-5 apart" "$apart"; fi
  row "" "" "PSNR after $short: $(paste "$work/psnr-$1-cuda-$short" "$work/psnr-$1-cpu-$short" | awk '{ printf "%+.2f dB", $1 - $2 }')"
}

has_scene() {
  [ ! -f "$work/scene.safetensors" ] || return 0
  [ -f scene.safetensors ] || { skip "$1" "the bundle has no scene"; return 1; }
  ln -s "$PWD/scene.safetensors" "$work/scene.safetensors"
}

step_train() {
  local method
  has_scene training || return
  train_and_score glint "$device" "$long" && row "" "" "$(training_split "$files/glint-$device-$long-log.jsonl")"
  for method in glint 2dgs envgs; do
    train_and_score "$method" "$device" "$short"
    [ "$device" = cpu ] || train_and_score "$method" cpu "$short"
    compare_devices "$method"
  done
}

# Every row of the table once, to be held against records of the CPU.
step_methods() {
  local method
  has_scene methods || return
  for method in 2dgs 2dgs/prior pgsr ref-gs envgs tsgs rt-splatting glint glint/plus; do
    train_and_score "$method" "$device" "$long"
  done
}

# The four kernels of ours in a glint step that take longest.
longest_kernels() {
  awk -F'"' '/"op":/ { op = $4 } /"kernel":/ { kernel = $4; sub(/<.*/, "", kernel); sub(/.*::/, "", kernel) }
    /"ms":/ && op == "glint training step" && kernel !~ /^(ExclusiveSum|SortPairs)$/ { gsub(/[^-0-9.e+]/, "", $3); print $3, kernel }' "$files/kernels-${sizes[0]}-$1.json" | sort -rg | awk '!seen[$2]++ { print $2 }' | head -n 4
}

step_profile() {
  command -v ncu >/dev/null || { skip profiler "no ncu here"; return; }
  local surfels=${counts[1]:-${counts[0]}} kernel
  [ -f "$files/kernels-${sizes[0]}-$surfels.json" ] || { skip profiler "needs the kernels' times (step perf)"; return; }
  for kernel in $(longest_kernels "$surfels"); do
    check "profile of $kernel" 30 ncu --clock-control none --set full --kernel-name-base demangled \
      --kernel-name "regex:$kernel" --launch-skip 1 --launch-count 1 glint-bench perf --quiet --device "$device" \
      --op 'glint training step' --runs 2 --width "${sizes[0]%x*}" --height "${sizes[0]#*x}" --surfels "$surfels" &&
      keep "profile-$kernel.txt"
  done
}

# Some virtual machines do not let it in: that says nothing about us.
step_sanitizer() {
  command -v compute-sanitizer >/dev/null || { skip compute-sanitizer "neither here nor in the bundle"; return; }
  local tool
  for tool in memcheck synccheck racecheck initcheck; do
    # As long as its share lasts. Calls that fail are the program's to see, not the sanitizer's.
    check "$tool" "$seconds" compute-sanitizer --require-cuda-init=no --report-api-errors no --tool $tool --error-exitcode 1 bin/gpu_tests && continue
    if grep -q "Device not supported" "$log"; then skip compute-sanitizer "it does not support this machine"; return; fi
  done
}

finish_summary() {
  { echo; echo "$failed failed, $undone not done, $SECONDS of $seconds s"; } | tee -a "$summary" >&2
  pack
  echo "gpu_check: $out/gpu_check.tar.gz" >&2
}

{ echo "# GPU check"; echo
  echo "$(date -u +%Y-%m-%dT%H:%M:%SZ), --device $device, steps: ${steps[*]}"; echo
  [ -f BUNDLE.md ] && { cat BUNDLE.md; echo; }
  echo "| step | result | |"; echo "|---|---|---|"; } >"$summary"
[ ! -f resources.txt ] || cp resources.txt "$files/"
# Up to when each step may go on.
declare -A ends=([machine]=45 [tests]=60 [scale]=120 [perf]=270 [train]=390 [methods]=560 [profile]=450 [sanitizer]=565)
for step in "${all_steps[@]}"; do
  share=${ends[$step]}
  if wanted "$step"; then "step_$step"; fi
done
finish_summary
[ "$failed" -eq 0 ] || exit 4
