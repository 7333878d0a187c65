#!/usr/bin/env bash
# A profile of a packed scene in a lean build, as on a machine with nothing but a GPU: planned, run, tabulated, shown; no meshes, no strips, and
# the pictures and scores of the full build: lean_all_test.sh GLINT_BENCH LEAN
# LEAN links what a lean build links. It is copied away from lib/, whose module for meshes a lean build does not have.
set -euo pipefail
bench=$(readlink -f "$1")
folder=$(mktemp -d /tmp/glint_lean.XXXXXX)
trap 'rm -rf "$folder"' EXIT
fail() { echo "FAILED: $*" >&2; cat "$folder"/*.err >&2; exit 1; }
mkdir "$folder/bin"
cp "$2" "$folder/bin/glint-bench"
lean=$folder/bin/glint-bench
cd "$folder"

"$bench" dataset make glassroom --scene room_1 --width 48 --height 27 --views 8 --spp 2 --out room --quiet 2>make.err
"$bench" dataset pack room room_1.safetensors --quiet 2>pack.err >/dev/null
cat >packed.toml <<'END'
iterations = 20
methods = ["2dgs", "glint"]
scenes = [{scene = "room_1", dataset = "glassroom", folder = "room_1.safetensors"}]
timing_frames = 2
timing_warmup = 1
END
common=(--profile packed.toml --data . --device cpu --quiet)

"$lean" status "${common[@]}" >plan.txt 2>plan.err || fail "status"
grep -q '^2 pending$' plan.txt || fail "status says $(cat plan.txt)"
"$lean" all "${common[@]}" --jobs 2 --for 1h >all.txt 2>all.err || fail "all: exit $?"
"$lean" status "${common[@]}" >status.txt 2>status.err || fail "status"
grep -q '^2 done$' status.txt || fail "status says $(tail -n 1 status.txt)"
"$lean" table --profile packed.toml --quiet >table.txt 2>table.err || fail "table"
"$lean" report --profile packed.toml --data . --quiet >report.txt 2>report.err || fail "report"
for file in records.jsonl tables/summary.md report/index.html runs/room_1/glint/0/renders; do
  [ -e "out/packed/$file" ] || fail "no $file"
done
grep -q '"mesh-cd":"no Open3D"' out/packed/records.jsonl || fail "nothing says why there are no meshes"
[ -z "$(find out -name strip.png -o -name 'mesh*.ply')" ] || fail "a lean build drew strips or made meshes"
"$lean" all --no-tables "${common[@]}" --json >again.json 2>again.err || fail "all --no-tables"
grep -q '"reused": 2' again.json || fail "finished cells were run again"
code=0; "$lean" figures --profile packed.toml --quiet >figures.txt 2>figures.err || code=$?
[ "$code" -eq 6 ] && grep -q 'this lean build cannot' figures.err || fail "figures: exit $code"

# The same pictures from the full build, but for what it traces, which may differ in its last bits.
"$bench" all --no-tables "${common[@]}" --only '*/2dgs/*' --out full >full.txt 2>full.err || fail "the full build"
scores() { grep '"method":"2dgs"' "$1" | grep -oE '"(psnr|ssim|depth-absrel|normal-mae)":[^,}]*'; }
[ "$(scores out/packed/records.jsonl | wc -l)" -ge 3 ] || fail "no scores in the record"
diff <(scores out/packed/records.jsonl) <(scores full/packed/records.jsonl) || fail "other scores than the full build's"
echo "two cells in a lean build, with the full build's scores"
