#!/usr/bin/env bash
# scripts/card_evidence.sh with stand-ins for all that a bundle has: what it asks for, its archives, its clock, what a kill leaves.
set -uo pipefail
script=$(cd "$(dirname "$0")/../.." && pwd)/scripts/card_evidence.sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bundle=$folder/bundle
failures=0

say() { echo "card_evidence_test: $1" >&2; failures=$((failures + 1)); }
expect() { "${@:2}" || say "$1"; }
has() { grep -q -- "$1" "$OUT/summary.md"; }
came_home() { tar -tf "$OUT/parcels_$1.tar" 2>/dev/null | grep -x "$2" >/dev/null; }

stand_in() { printf '#!/usr/bin/env bash\n%s\n' "$2" >"$bundle/bin/$1"; chmod +x "$bundle/bin/$1"; }
new_bundle() {
  rm -rf "$bundle"
  mkdir -p "$bundle/bin" "$bundle/profile" "$bundle/scenes"
  cp "$script" "$bundle/"
  : >"$bundle/environment.sh"
  echo "Commit 123" >"$bundle/BUNDLE.md"
  echo 'iterations = 5' >"$bundle/profile/small.toml"
  printf 'room_1/2dgs/0\nroom_1/glint/0\n' >"$bundle/cells.txt"
  stand_in gpu-probe 'echo kernel ran'
  stand_in nvidia-smi 'case $1 in *compute-apps*) ;; *) echo "a card, 580" ;; esac'
  # Two cells: the second takes longer.
  stand_in glint-bench '
    value() { sed -n "s/.*$1 \([^ ]*\).*/\1/p" <<<"$*"; }
    echo "ASKED $*" >&2
    case $1 in
      all)
        parcels=$(sed -n "s/.*--parcels \([^ ]*\).*/\1/p" <<<"$*") out=$(sed -n "s/.*--out \([^ ]*\).*/\1/p" <<<"$*")
        head -c "${BYTES:-1000}" /dev/zero >"$parcels/room_1+2dgs+0.parcel"
        sleep "${SLOW:-1}"
        head -c "${BYTES:-1000}" /dev/zero >"$parcels/room_1+glint+0.parcel"
        mkdir -p "$out/small/runs/room_1/glint/plus/0"; echo {} >"$out/small/runs/room_1/glint/plus/0/record.json"
        exit "${CODE:-0}" ;;
      table) echo "| a table |" ;;
      perf) echo "200 frames a second" ;;
    esac'
}

export OUT=$folder/out
run() { rm -rf "$OUT"; "$bundle/card_evidence.sh" "$@" 2>"$folder/err"; }

new_bundle
run --seconds 60 --max-failures 3
expect "all well: exit 0" [ $? = 0 ]
expect "cells are asked for in their order, within the time" grep -qE \
  'ASKED all --no-tables --profile .*profile/small.toml --data scenes .*--device cuda --jobs 4 --order given --cells cells.txt --for 3[0-9]s --parcels .* --quiet --max-failures 3' "$OUT/log.txt"
expect "both parcels came home" came_home 1 room_1+2dgs+0.parcel
expect "both parcels came home" came_home 1 room_1+glint+0.parcel
expect "few files" [ "$(find "$OUT" -type f | wc -l)" = 3 ]
expect "card, commit and table are told" has "a card, 580"
expect "card, commit and table are told" has "Commit 123"
expect "card, commit and table are told" has "| a table |"
expect "frames a second, by method" has "frames a second of glint/plus: ok"

# Archives of at most 15 MiB, no more than six.
BYTES=$((9 << 20)) run --seconds 60
expect "a second archive when the first is full" came_home 2 room_1+glint+0.parcel
for archive in "$OUT"/parcels_*.tar; do expect "none above 16 MiB" [ "$(stat -c %s "$archive")" -le $((16 << 20)) ]; done

CODE=5 run --seconds 60
expect "cells that are left: exit 5" [ $? = 5 ]
expect "what there was came home" came_home 1 room_1+2dgs+0.parcel

stand_in nvidia-smi 'case $1 in *compute-apps*) echo "77, 900 MiB" ;; *) echo "a card, 580" ;; esac'
run --seconds 60
expect "others on the card are told" has "Others are on the card, so times mean little: 77, 900 MiB"
stand_in gpu-probe 'echo "no device" >&2; exit 6'
run --seconds 60
expect "no kernel runs: exit 6" [ $? = 6 ]
expect "no kernel runs: told" has "No kernel runs on this machine"
run --seconds 20 --device cpu
expect "too short a time: exit 6" [ $? = 6 ]
expect "too short a time: told" has "No time for any cell"
run --seconds soon
expect "a time that is none: exit 1" [ $? = 1 ]
: >"$bundle/cells.txt"
run
expect "nothing to do: exit 6" [ $? = 6 ]
expect "nothing to do: told" grep -q "all of them have records" "$folder/err"

# A kill loses the cell at hand.
new_bundle
rm -rf "$OUT"
SLOW=60 setsid "$bundle/card_evidence.sh" --device cpu 2>/dev/null &
killed=$!
for _ in $(seq 100); do came_home 1 room_1+2dgs+0.parcel && break; sleep 0.2; done
kill -KILL -- "-$killed"
wait "$killed" 2>/dev/null
expect "after a kill: what was done" came_home 1 room_1+2dgs+0.parcel

[ $failures = 0 ] || exit 1
