#!/usr/bin/env bash
# Fuzzes the byte parsers (tests/fuzz, libFuzzer): scripts/fuzz.sh [--seconds 600] [--again] [TARGET...].
# Each target for so long, from its seeds, its corpus in tests/fuzz/corpus and what earlier runs found
# (build/fuzz/corpus, made small again at the end). A line for each run goes to docs/results/fuzzing.jsonl; a
# target that has one of this commit and as many seconds is passed over, but for --again. Bytes that a
# finding needs are in build/fuzz/findings/TARGET. Exits with 4 where there are findings.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=600 again=0 targets=()
while [ $# -gt 0 ]; do
  case $1 in
    --seconds) seconds=${2:?seconds} && shift ;;
    --again) again=1 ;;
    -*) echo "unknown option $1; see the head of $0" >&2 && exit 1 ;;
    *) targets+=("$1") ;;
  esac
  shift
done
scripts/build.sh fuzz fuzz test_fuzz
work=$PWD/build/fuzz records=docs/results/fuzzing.jsonl
commit=$(git rev-parse --short=12 HEAD)
git diff --quiet HEAD -- '*.cpp' '*.h' '*.cmake' '*CMakeLists.txt' || commit=$commit-changed
if [ ${#targets[@]} -eq 0 ]; then mapfile -t targets < <("$work/tests/test_fuzz" --list); fi
# No parser may take much more memory than its file holds before it has looked at it; sizes up to the 256 MiB
# that a header may claim (check_claimed_size) come in several copies.
limits=(-rss_limit_mb=1024 -malloc_limit_mb=1024 -timeout=10 -max_len=65536)
export ASAN_OPTIONS=quarantine_size_mb=16:allocator_may_return_null=0:detect_leaks=1

done_before() { # target: does a line of this commit have as many seconds?
  [ $again = 0 ] && [ -f "$records" ] &&
    grep -F "\"commit\":\"$commit\"" "$records" | grep -F "\"target\":\"$1\"" |
    sed 's/.*"seconds":\([0-9]*\).*/\1/' | awk -v s="$seconds" '$1 >= s { found = 1 } END { exit !found }'
}

stat() { sed -n "s/^stat::$1: *//p" "$2" | tail -1; }

fuzz() { # target
  local target=$1 corpus=$work/corpus/$1 findings=$work/findings/$1 log=$work/log/$1.txt status=0
  mkdir -p "$corpus" "$findings" "$work/log" "$work/seeds/$target" "tests/fuzz/corpus/$target"
  ln -sf glint_fuzz "$work/tests/fuzz-$target"
  "$work/tests/test_fuzz" --seeds "$target" "$work/seeds/$target" >/dev/null 2>&1
  local before=$(ls "$findings" | wc -l) start=$(date +%s)
  nice -n 15 "$work/tests/fuzz-$target" "${limits[@]}" -max_total_time="$seconds" -print_final_stats=1 -close_fd_mask=3 \
    -artifact_prefix="$findings/" "$corpus" "$work/seeds/$target" "tests/fuzz/corpus/$target" >"$log" 2>&1 || status=$?
  local took=$(($(date +%s) - start)) found=$(($(ls "$findings" | wc -l) - before))
  local edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  printf '{"target":"%s","seconds":%d,"executions":%d,"per_second":%d,"edges":%d,"peak_mb":%d,"findings":%d,"commit":"%s","date":"%s"}\n' \
    "$target" "$took" "$(stat number_of_executed_units "$log")" "$(stat average_exec_per_sec "$log")" "${edges:-0}" \
    "$(stat peak_rss_mb "$log")" "$found" "$commit" "$(date -u +%FT%TZ)" | tee -a "$records"
  if [ $status -ne 0 ]; then tail -40 "$log" >&2; return 4; fi
  rm -rf "$corpus.small" && mkdir "$corpus.small"
  nice -n 15 "$work/tests/fuzz-$target" "${limits[@]}" -merge=1 -close_fd_mask=3 "$corpus.small" "$corpus" >"$log.merge" 2>&1 &&
    rm -rf "$corpus" && mv "$corpus.small" "$corpus"
}

mkdir -p "$(dirname "$records")"
result=0
for target in "${targets[@]}"; do
  if done_before "$target"; then echo "$target: done before" >&2; continue; fi
  fuzz "$target" || result=4
done
exit $result
