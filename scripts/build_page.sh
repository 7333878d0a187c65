#!/usr/bin/env bash
# Rebuilds reports/show/page/dist, the program of the report page, from reports/show/page/web (Node.js 18 or
# newer; its packages come from the registry of npm). Users never need this: dist is committed and
# compiled into glint-bench.
#   scripts/build_page.sh           build, and record the sources that were built
#   scripts/build_page.sh --check   only compare the record with the sources (exit code 4: older)
set -euo pipefail
cd "$(dirname "$0")/../reports/show/page"

sources_hash() {
  find web -type f -not -path '*/node_modules/*' | LC_ALL=C sort | xargs sha256sum | sha256sum | cut -d' ' -f1
}

if [ "${1:-}" = "--check" ]; then
  if [ "$(cat dist/SOURCES)" != "$(sources_hash)" ]; then
    echo "reports/show/page/dist is older than reports/show/page/web; run scripts/build_page.sh and commit the result" >&2
    exit 4
  fi
  echo "reports/show/page/dist is up to date"
  exit 0
fi

if ! command -v npm >/dev/null; then
  echo "build_page: no npm; install nodejs and npm" >&2
  exit 6
fi
(cd web && npm ci --silent --no-audit --no-fund && node build.mjs)
sources_hash >dist/SOURCES
echo "built $(du -bc dist/* | tail -1 | cut -f1) bytes into reports/show/page/dist"
