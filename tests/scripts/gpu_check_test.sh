#!/usr/bin/env bash
# scripts/gpu_check.sh with stand-ins for all that a bundle has: its order, its clock, what it leaves behind.
set -uo pipefail
script=$(cd "$(dirname "$0")/../.." && pwd)/scripts/gpu_check.sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bundle=$folder/bundle
failures=0

say() { echo "gpu_check_test: $1" >&2; failures=$((failures + 1)); }
expect() { "${@:2}" || say "$1"; }
has() { grep -q -- "$1" "$OUT/summary.md"; }
archived() { tar -tzf "$OUT/gpu_check.tar.gz" | grep -x "gpu_check/$1" >/dev/null; }

# stand_in NAME LINES: a program of the bundle.
stand_in() { printf '#!/usr/bin/env bash\n%s\n' "$2" >"$bundle/bin/$1"; chmod +x "$bundle/bin/$1"; }
new_bundle() {
  rm -rf "$bundle"
  mkdir -p "$bundle/bin/no-fmad"
  cp "$script" "$bundle/"
  echo 'unxz_to_output() { xz -dc "$1"; }' >"$bundle/environment.sh"
  echo "Commit 123" >"$bundle/BUNDLE.md"
  echo kernels >"$bundle/resources.txt"
  echo scene >"$bundle/scene.safetensors"
  stand_in gpu-probe 'echo kernel ran'
  stand_in nvidia-smi 'echo a card'
  stand_in gpu_tests \
    'printf "1.0e-05\t1.0e-04\tcard\ttest\tarray\n" >>"$GLINT_DIFFERENCES"; echo "require ${GLINT_REQUIRE_GPU:-0}"'
  cp "$bundle/bin/gpu_tests" "$bundle/bin/no-fmad/"
  stand_in compute-sanitizer 'echo "$@"'
  stand_in ncu 'echo "$@"'
  stand_in glint-bench '
    run=$(echo "$@" | sed -n "s/.*--run \([^ ]*\).*/\1/p")
    case "$1 $*" in
      perf*--kernels*) printf "  \"op\": \"glint training step\",\n  \"kernel\": \"Blend<3>\",\n  \"ms\": 1.5\n" ;;
      perf*) printf "  \"op\": \"2dgs training step\",\n  \"ms\": 2.5,\n" ;;
      train*)
        mkdir -p "$run/renders/0"
        loss=1; [[ $run != *-cpu-* ]] || loss=${LOSS_OF_CPU:-3}
        for i in 0 1 2 3 4; do
          echo "{\"iteration\":$((10 * i)),\"loss\":0.50000$loss,\"num_surfels\":$((i < 3 ? 100 : 150)),\"seconds\":$((i < 3 ? i : i + 2)).0,\"saving_seconds\":0.5,\"void_steps\":$((i < 2 ? i : 2))}"
        done >"$run/log.jsonl"
        echo picture >"$run/renders/0/rgb.png" ;;
      eval*) printf "  \"psnr\": %s.5,\n" "$(grep -c cuda <<<"$run")" ;;
    esac'
}

export OUT=$folder/out
run() { rm -rf "$OUT"; "$bundle/gpu_check.sh" "$@" 2>"$folder/err"; }

new_bundle
run
expect "all well: exit 0" [ $? = 0 ]
expect "differences are told" has 'most: 0.100 of the allowed, array in: test, card'
expect "steps are told" has '2dgs training step 2.50'
# 1 s for each ten iterations, but for the line where surfels were added: 3 s.
expect "a training is split" has 'step 100.00 ms (median), densification 2.00 s, saving 0.50 s, of 6.50 s; 100 to 150 surfels, most 150; 2 steps left out, the last by iteration 20'
expect "the longest kernel is profiled" has 'profile of Blend'
expect "sanitizers do not ask for CUDA" grep -q -- '--require-cuda-init=no --report-api-errors no --tool racecheck' "$OUT/log.txt"
expect "a GPU is required" grep -q 'require 1' "$OUT/log.txt"
expect "what is not there is said" has 'parity at scale | not done: not in the bundle'
for file in summary.md log.txt resources.txt probe.txt differences-tests-of-ops.txt differences-tests-of-ops--no-fmad.txt steps-480x270-20000.json \
  kernels-480x270-100000.json ops.json glint-cuda-2000-log.jsonl envgs-cpu-200-eval.json glint-cuda-200.png; do
  expect "$file is in the archive" archived "$file"
done
expect "the folder has few files" [ "$(find "$OUT" -type f | wc -l)" = 3 ]
order=$(grep -oE '^\| (nvidia-smi|tests of ops|steps, 480|steps, 240|train glint|profile|memcheck)' "$OUT/summary.md" | uniq | tr -d '\n')
expect "the order: $order" [ "$order" = '| nvidia-smi| tests of ops| steps, 480| steps, 240| train glint| profile| memcheck' ]

expect "devices alike are told" has 'glint on both devices | ok | losses of ten steps 4.0e-06 apart'
expect "what came of it is told" has 'PSNR after 200: +1.00 dB'
LOSS_OF_CPU=8 run train
expect "devices apart: exit 4" [ $? = 4 ]
expect "devices apart are told" has 'glint on both devices | \*\*failed\*\*: losses of the first ten steps more than 1e-5 apart | 1.4e-05'

run methods
expect "methods, if asked for" has 'PSNR glint/plus, cuda, 2000 iterations'
expect "a variant's files" archived glint+plus-cuda-2000-eval.json

stand_in gpu_tests 'echo "1 of 3 failed"; exit 1'
run tests
expect "a failed test: exit 4" [ $? = 4 ]
expect "a failed test is told" has '\*\*failed\*\*: exit code 1: 1 of 3 failed'

stand_in gpu-probe 'echo "no device" >&2; exit 6'
run
expect "no kernel runs: exit 6" [ $? = 6 ]
expect "nothing else is tried" [ "$(grep -c 'perf\|train' "$OUT/log.txt")" = 0 ]
expect "an archive all the same" archived summary.md

# The clock: what hangs gets its step's share, and what comes after has its own.
new_bundle
stand_in gpu_tests 'echo begun; sleep 60'
start=$SECONDS
run --seconds 60 tests perf
expect "a share that is used up is no failure" [ $? = 0 ]
expect "the clock holds" [ $((SECONDS - start)) -le 15 ]
expect "what was cut off is told" has 'not done: stopped after [0-9]* s, no time left'
expect "what had no time is told" has 'no time left'
expect "the next step has its time" has '2dgs training step 2.50'

# A kill loses nothing but the check that it hits.
stand_in glint-bench 'case $1 in perf) echo half; sleep 30 ;; esac'
rm -rf "$OUT"
setsid "$bundle/gpu_check.sh" --device cpu machine perf 2>/dev/null &
killed=$!
for _ in $(seq 50); do grep -qs half "$OUT/log.txt" && break; sleep 0.2; done
kill -KILL -- "-$killed"
wait "$killed" 2>/dev/null
expect "after a kill: the archive of what was done" archived doctor.txt
expect "after a kill: what the running check had said" grep -q half "$OUT/log.txt"

[ $failures = 0 ] || exit 1
