#!/usr/bin/env bash
# The whole way of evidence from a card, rehearsed on the CPU with a tiny room: packed as bundle.sh does, trained and scored by
# card_evidence.sh from the packed scene without meshes, its archives merged into a store at home, where meshes are made and scored:
#   card_rehearsal_test.sh GLINT_BENCH
set -euo pipefail
bench=$1 scripts=$(cd "$(dirname "$0")/../.." && pwd)/scripts
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
fail() { echo "card_rehearsal_test: $1" >&2; tail -n 30 home_out/log card_out/log.txt >&2 || true; exit 1; }

mkdir -p home bundle/bin bundle/profile bundle/scenes home_out
cat >home/tiny.toml <<'TOML'
iterations = 40
methods = ["2dgs", "glint"]
scenes = ["room_1"]

[defaults]
width = 64
height = 36
views = 10
spp = 4

[mesh]
voxel = 0.05

[mesh_metrics]
num_samples = 5000
TOML
home=(--profile home/tiny.toml --out home_out --data data)
"$bench" run "${home[@]}" --data-only --quiet
"$bench" dataset pack data/glassroom/room_1-* bundle/scenes/room_1.safetensors --compact --without basecolor >/dev/null
sed 's|^scenes = .*|scenes = [{scene = "room_1", dataset = "glassroom", folder = "room_1.safetensors"}]|
  /^\[defaults\]/,/^\[mesh\]/ { /^\[mesh\]/!d }' home/tiny.toml >bundle/profile/tiny.toml
"$bench" status --tasks --quiet "${home[@]}" | cut -f1 >bundle/cells.txt
ln -s "$bench" bundle/bin/glint-bench
cp "$scripts/card_evidence.sh" bundle/
: >bundle/environment.sh
echo "Commit of a rehearsal" >bundle/BUNDLE.md

OUT=$folder/card_out bundle/card_evidence.sh --device cpu --jobs 2 --seconds 150 2>/dev/null || fail "card_evidence.sh: exit code $?"
grep -q 'GLINT' card_out/summary.md || fail "no table in summary.md"
grep -q 'frames a second of glint: ok' card_out/summary.md || fail "no frames a second"

# The end of an archive that was cut off is named, and what is whole is taken.
head -c $(($(stat -c %s card_out/parcels_1.tar) * 2 / 3)) card_out/parcels_1.tar >cut.tar
code=0
"$bench" merge cut.tar "${home[@]}" --quiet >home_out/log 2>&1 || code=$?
[ $code = 5 ] || fail "an archive that was cut off: exit code $code, expected 5"
[ "$(wc -l <home_out/tiny/records.jsonl)" -ge 1 ] || fail "nothing was taken of an archive that was cut off"

"$bench" merge card_out/parcels_*.tar "${home[@]}" --quiet >home_out/log 2>&1 || fail "merge: exit code $?"
for method in 2dgs glint; do
  grep "\"method\":\"$method\"" home_out/tiny/records.jsonl | tail -n 1 >record
  grep -q '"mesh-cd":' record || fail "$method: no mesh was scored"
  grep -q '"psnr":' record || fail "$method: no picture was scored"
done
"$bench" table --out home_out/tiny --table summary | grep -q GLINT || fail "no table at home"
before=$(wc -l <home_out/tiny/records.jsonl)
"$bench" merge card_out/parcels_*.tar "${home[@]}" --quiet >home_out/log 2>&1 || fail "merge again: exit code $?"
[ "$(wc -l <home_out/tiny/records.jsonl)" = "$before" ] || fail "merging again changed the records"
