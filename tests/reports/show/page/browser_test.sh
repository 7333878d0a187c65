#!/usr/bin/env bash
# browser_test.sh GLINT_BENCH [SCREENSHOT_FOLDER]: the report page of a small run in headless Chromium.
# Exit code 77 (skipped) where the browser, Node.js or playwright-core are absent.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source "$here/browser_tools.sh"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bench=("$1" report --profile "$here/browser.toml" --out "$work" --data "$work/data" --quiet)
"$1" all "${bench[@]:2}" >/dev/null
cp "$here/tiny_mesh.ply" "$work/browser/runs/room_1/2dgs/0/mesh.ply"
cat "$here/failed_record.jsonl" >>"$work/browser/records.jsonl"
"${bench[@]}" >/dev/null
mkdir -p "$work/single"
cp -r "$work/browser" "$work/single/"
"$1" report --profile "$here/browser.toml" --out "$work/single" --data "$work/data" --quiet --single-file >/dev/null
run_tests() {
  node "$here/browser_test.mjs" \
    "$work/browser/report/index.html" "$work/single/browser/report/index.html" "${2:-$work/shots}"
}
run_tests "$@"
