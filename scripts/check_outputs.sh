#!/usr/bin/env bash
# Checks what `glint-bench all` wrote: scripts/check_outputs.sh OUT/PROFILE. Exit 4 names what is missing.
set -euo pipefail
out=$1
fail() { echo "check_outputs: $*" >&2; exit 4; }

[ -s "$out/records.jsonl" ] || fail "$out/records.jsonl is missing or empty"
if grep -q '"status":"failed"' "$out/records.jsonl"; then fail "a cell failed: see $out/records.jsonl"; fi
for table in table1_photometric table2_geometry table3_ablation tableB_cost regions decomposition; do
  for format in md tex csv json; do
    [ -s "$out/tables/$table.$format" ] || fail "$out/tables/$table.$format is missing or empty"
  done
done
[ -s "$out/tables/all.tex" ] || fail "$out/tables/all.tex is missing or empty"
for figure in qualitative curves f1 meshes; do
  for kind in png pdf; do
    [ -s "$out/figures/$figure.$kind" ] || fail "$out/figures/$figure.$kind is missing or empty"
  done
done
grep -q '^2DGS\|^2dgs' "$out/tables/table1_photometric.csv" || fail "no row for 2dgs in table1_photometric.csv"
for file in index.html assets/data.js assets/scene_0.js assets/probe_0_0.js assets/pictures/s0/v0_r0_rgb.png; do
  [ -s "$out/report/$file" ] || fail "$out/report/$file is missing or empty"
done
# Variants (2dgs/prior) are one folder deeper than methods.
runs=0
while IFS= read -r config; do
  run=$(dirname "$config")
  for file in config.json env.json metrics.json log.jsonl interface.ply mesh.ply mesh.json; do
    [ -s "$run/$file" ] || fail "$run/$file is missing or empty"
  done
  compgen -G "$run/renders/*/rgb.exr" >/dev/null || fail "$run has no renders"
  runs=$((runs + 1))
done < <(find "$out/runs" -name config.json)
[ "$runs" -eq "$(grep -o '"scene":"[^"]*","method":"[^"]*","seed":[0-9]*' "$out/records.jsonl" | sort -u | wc -l)" ] ||
  fail "$runs run folders in $out/runs, but another number of cells in $out/records.jsonl"
[ "$runs" -gt 0 ] || fail "no run folders in $out/runs"
echo "check_outputs: $runs runs, six tables in five formats, figures, a page" >&2
