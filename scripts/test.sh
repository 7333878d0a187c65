#!/usr/bin/env bash
# From nothing to a test summary: set-up, build, all tests. Arguments go to ctest, for example:
# scripts/test.sh -R render
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release
exec ctest --preset release -j "$(nproc)" "$@"
