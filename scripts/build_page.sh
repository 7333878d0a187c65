#!/usr/bin/env bash
# Rebuilds the programs of the report page (reports/show/page/dist, from reports/show/page/web) and of
# `glint-bench view` (reports/show/viewer/dist, from reports/show/viewer/web and modules of the page).
# Node.js 18 or newer; packages come from the registry of npm. Users never need this: both dist are
# committed and compiled into glint-bench.
#   scripts/build_page.sh           build, and record the sources that were built
#   scripts/build_page.sh --check   only compare the records with the sources (exit code 4: older)
set -euo pipefail
cd "$(dirname "$0")/../reports/show"

# sources_hash FOLDER...
sources_hash() {
  find "$@" -type f -not -path '*/node_modules/*' | LC_ALL=C sort | xargs sha256sum | sha256sum | cut -d' ' -f1
}
page_hash() {
  (cd page && sources_hash web)
}
viewer_hash() {
  sources_hash page/web viewer/web
}

# check NAME HASH
check() {
  if [ "$(cat "$1/dist/SOURCES")" != "$2" ]; then
    echo "reports/show/$1/dist is older than its sources; run scripts/build_page.sh and commit the result" >&2
    exit 4
  fi
  echo "reports/show/$1/dist is up to date"
}

if [ "${1:-}" = "--check" ]; then
  check page "$(page_hash)"
  check viewer "$(viewer_hash)"
  exit 0
fi

if ! command -v npm >/dev/null; then
  echo "build_page: no npm; install nodejs and npm" >&2
  exit 6
fi
mkdir -p viewer/dist
(cd page/web && npm ci --silent --no-audit --no-fund && node build.mjs)
page_hash >page/dist/SOURCES
viewer_hash >viewer/dist/SOURCES
for name in page viewer; do
  echo "built $(du -bc $name/dist/* | tail -1 | cut -f1) bytes into reports/show/$name/dist"
done
