#!/usr/bin/env bash
# viewer_test.sh GLINT_BENCH [SCREENSHOT_FOLDER [STORE]]: the viewer's page in headless Chromium, against
# `glint-bench view` of two small runs and a training, or of runs of a store that is there (OUT/NAME, with 2dgs
# and glint on one scene). viewer_test.sh --mock [SCREENSHOT_FOLDER]: against a mock server.
# Exit code 77 (skipped) where the browser, Node.js or playwright-core are absent.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source "$here/../page/browser_tools.sh"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
shots=${2:-$work/shots}
if [ "$1" = --mock ]; then
  node --test "$here/viewer_units_test.mjs" >"$work/units" || { cat "$work/units"; exit 1; }
  node "$here/viewer_mock_test.mjs" "$shots"
  exit 0
fi
profile=$here/../page/browser.toml
store=${3:-$work/browser}
[ -d "$store" ] || "$1" all --profile "$profile" --out "$work" --data "$work/data" --quiet >/dev/null
scene=$(echo "$work"/data/glassroom/*/)
[ -d "$scene" ] || scene=
node "$here/viewer_test.mjs" "$1" "$store" "$shots" ${scene:+"$scene"}
