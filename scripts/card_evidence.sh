#!/usr/bin/env bash
# Cells of a profile that have no record yet, on a bare machine with a GPU and without a network, until the time is up; from the folder that
# `scripts/bundle.sh --evidence` makes:
#   ./card_evidence.sh [--seconds N (570)] [--profile FILE (profile/*.toml)] [--jobs N (4)] [--device cuda|cpu] [options of `glint-bench all`]
# Cells run side by side in the order of cells.txt, most wanted first. To $OUT (default ./card_out), as they come, so that a kill loses one cell:
# parcels_1.tar to parcels_6.tar of at most 15 MiB, which `glint-bench merge parcels_*.tar` takes over at home; summary.md; log.txt.
# Time that is left goes to what else only a card can tell: frames a second of the trained models, a long training on speed.safetensors,
# sanitizers, gsplat; each where the bundle has what it takes.
# Exit 5: cells are left (the same bundle goes on with another call); 6: no kernel runs here, or there was no time for any cell.
set -uo pipefail

seconds=570 profile= jobs=4 device=cuda options=()
while [ $# -gt 0 ]; do
  case $1 in
    --seconds) seconds=$2; shift 2 ;;
    --profile) profile=$(readlink -f "$2"); shift 2 ;;
    --jobs) jobs=$2; shift 2 ;;
    --device) device=$2; shift 2 ;;
    *) options+=("$1"); shift ;;
  esac
done
case $seconds$jobs in *[!0-9]*) echo "card_evidence: --seconds $seconds --jobs $jobs: expected whole numbers" >&2; exit 1 ;; esac
reserve=25  # seconds kept back for the last packing
most_bytes=$((15 << 20)) most_archives=6

out=${OUT:-$PWD/card_out}
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$(dirname "$0")" || exit 6
[ -x bin/glint-bench ] || [ -f programs.tar.xz ] ||
  { echo "card_evidence: neither bin/glint-bench nor programs.tar.xz in $PWD; run scripts/bundle.sh --evidence first" >&2; exit 6; }
# shellcheck source=/dev/null
source ./environment.sh
PATH=$PWD/bin:$PATH:/usr/local/cuda/bin
profile=${profile:-$(echo profile/*.toml)}
[ -f "$profile" ] || { echo "card_evidence: $profile: no such profile; bundle.sh --evidence packs one, or name it with --profile" >&2; exit 6; }
name=$(basename "$profile" .toml)  # of the profile
[ -s cells.txt ] || { echo "card_evidence: cells.txt has no cell: all of them have records" >&2; exit 6; }
work=$(mktemp -d)
parcels=$work/parcels
mkdir "$parcels"
runner=
finish() { [ -z "$runner" ] || kill "$runner" 2>/dev/null; rm -rf "$work"; }
trap finish EXIT
log=$out/log.txt summary=$out/summary.md
rm -f "$out"/parcels_*.tar
: >"$log"

left() { echo $((seconds - SECONDS)); }
say() { echo "$*" | tee -a "$summary" >&2; }
# spare NAME SECONDS_NEEDED COMMAND...: within the time left; output to the log, its standard output to $work/last, too.
spare() {
  local name=$1 needed=$2 code start=$SECONDS limit
  shift 2
  limit=$(($(left) - 5))
  [ "$limit" -ge "$needed" ] || { say "- $name: no time left ($limit s, $needed needed)"; return 1; }
  echo "== $name: $*" >>"$log"
  timeout --kill-after=3 "$limit" "$@" 2>>"$log" | tee -a "$log" >"$work/last"
  code=${PIPESTATUS[0]}
  say "- $name: $([ "$code" = 0 ] && echo ok || echo "exit code $code"), $((SECONDS - start)) s"
  return "$code"
}

# New parcels to the archive that is not full; those of a cell that was tried again once more.
declare -A packed=()
archive=1 num_packed=0 no_room=()
pack() {
  local file parcel stamp size used
  for file in "$parcels"/*.parcel; do
    [ -f "$file" ] || continue
    parcel=$(basename "$file") stamp=$(stat -c %Y.%s "$file") size=$(stat -c %s "$file")
    [ "${packed[$parcel]:-}" != "$stamp" ] || continue
    used=$(stat -c %s "$out/parcels_$archive.tar" 2>/dev/null || echo 0)
    if [ "$used" -gt 0 ] && [ $((used + size + 2048)) -gt $most_bytes ]; then archive=$((archive + 1)); fi
    if [ $archive -gt $most_archives ]; then archive=$most_archives; no_room+=("$parcel"); packed[$parcel]=$stamp; continue; fi
    tar -rf "$out/parcels_$archive.tar" -C "$parcels" "$parcel" && packed[$parcel]=$stamp && num_packed=$((num_packed + 1))
  done
}

{ echo "# Cells on a card"; echo
  echo "$(date -u +%Y-%m-%dT%H:%M:%SZ), card_evidence.sh --seconds $seconds --jobs $jobs --device $device ${options[*]}"; echo
  cat BUNDLE.md; echo; } >"$summary"
if [ "$device" = cuda ]; then
  nvidia-smi --query-gpu=name,driver_version,memory.total --format=csv,noheader >>"$summary" 2>>"$log" || say "nvidia-smi: not found or failed"
  others=$(nvidia-smi --query-compute-apps=pid,used_memory --format=csv,noheader 2>/dev/null)
  [ -z "$others" ] || say "Others are on the card, so times mean little: $others"
  if [ -x bin/gpu-probe ] && ! timeout 60 bin/gpu-probe >>"$log" 2>&1; then
    say "No kernel runs on this machine: $(tail -n 1 "$log")"
    exit 6
  fi
fi

time_for_cells=$(($(left) - reserve))
[ $time_for_cells -ge 10 ] || { say "No time for any cell: $time_for_cells s of $seconds are left; give more --seconds"; exit 6; }
glint-bench all --no-tables --profile "$profile" --data scenes --out "$work/out" --device "$device" --jobs "$jobs" --order given --cells cells.txt \
  --for "${time_for_cells}s" --parcels "$parcels" --quiet "${options[@]}" >>"$log" 2>&1 &
runner=$!
while kill -0 $runner 2>/dev/null; do
  sleep 2
  pack
done
wait $runner
code=$?
runner=
pack
say ""
say "glint-bench all: exit code $code; $num_packed parcels in $(find "$out" -name 'parcels_*.tar' | wc -l) archives, $SECONDS of $seconds s"
[ ${#no_room[@]} -eq 0 ] || say "No room in $most_archives archives for: ${no_room[*]}"
[ "$code" = 0 ] || say "$(grep -v '^==' "$log" | tail -n 3)"
say ""
glint-bench table --out "$work/out/$name" --table summary >>"$summary" 2>>"$log" || true

# What else only a card can tell.
say ""
say "## Beside that"
mapfile -t runs < <(find "$work/out/$name/runs" -name record.json -printf '%h\n' 2>/dev/null | sort)
seen=()
how=()
[ "$device" = cuda ] || how=(--frames 1 --sizes 64x36)  # a rehearsal
for run in "${runs[@]}"; do
  method=$(dirname "${run#"$work/out/$name/runs/"*/}")
  [[ " ${seen[*]} " != *" $method "* ]] || continue
  seen+=("$method")
  spare "frames a second of $method" 10 glint-bench perf --quiet --run "$run" "${how[@]}" --device "$device" && { cat "$work/last"; echo; } >>"$summary"
done
if [ -f scenes/speed.safetensors ]; then
  spare "60,000 steps of glint on speed.safetensors" 120 glint-bench train --quiet --dataset scenes/speed.safetensors --method glint \
    --device "$device" --iterations "${SPEED_ITERATIONS:-60000}" --run "$work/speed" --json && { cat "$work/last"; tail -n 1 "$work/speed/log.jsonl"; } >>"$summary"
fi
if [ -x bin/gpu_tests ] && command -v compute-sanitizer >/dev/null; then
  share=3  # of the time that is left, each gets its part; what it does not reach counts as stopped (exit code 124)
  for tool in racecheck synccheck initcheck; do
    spare "$tool" 30 timeout $(($(left) / share)) \
      compute-sanitizer --require-cuda-init=no --report-api-errors no --tool $tool --error-exitcode 1 bin/gpu_tests
    share=$((share - 1))
  done
fi
if [ -d gsplat ] && spare gsplat 150 env OUT="$work" ./gsplat_check.sh; then cat "$work/gsplat.md" >>"$summary"; fi
exit "$code"
