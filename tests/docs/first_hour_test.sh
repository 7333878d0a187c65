#!/usr/bin/env bash
# docs/guide/first_hour.md can be followed by copy and paste: its `sh` blocks, in order, in an empty folder.
#   first_hour_test.sh GLINT_BENCH
set -euo pipefail
page=$(readlink -f "$(dirname "$0")/../../docs/guide/first_hour.md")
PATH=$(dirname "$(readlink -f "$1")"):$PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 } inside' "$page" >commands
[ "$(wc -l <commands)" -ge 15 ] || { echo "FAILED: only $(wc -l <commands) commands on the page" >&2; exit 1; }
bash -eux commands
[ -s out/smoke/report/index.html ] && [ -s out/single/tables/summary.md ] && [ -s out/hour/glint/mesh.ply ]
echo "the first hour can be followed"
