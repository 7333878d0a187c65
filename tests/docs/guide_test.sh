#!/usr/bin/env bash
# A page of docs/guide can be followed by copy and paste: its `sh` blocks, in order, in an empty folder.
#   guide_test.sh GLINT_BENCH PAGE COMMANDS FILE...: at least so many lines, after which the files are there
set -euo pipefail
page=$(readlink -f "$(dirname "$0")/../../docs/guide/$2.md")
PATH=$(dirname "$(readlink -f "$1")"):$PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
awk '/^```sh$/ { inside = 1; next } /^```/ { inside = 0 } inside' "$page" >commands
[ "$(wc -l <commands)" -ge "$3" ] || { echo "FAILED: only $(wc -l <commands) commands on the page" >&2; exit 1; }
bash -eux commands
for file in "${@:4}"; do
  [ -s "$file" ] || { echo "FAILED: no $file" >&2; exit 1; }
done
echo "$2 can be followed"
