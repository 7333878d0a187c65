#!/usr/bin/env bash
# From nothing to the tables: set-up, build, `glint-bench all --profile ci`, a cell on each core. Arguments go to
# glint-bench, for example: scripts/bench.sh --profile small --jobs 1
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/setup.sh
scripts/build.sh release programs
if [ $# -eq 0 ]; then
  set -- --profile ci
fi
case " $* " in
  *" --jobs"* | *" --executor inline"*) ;;
  *) set -- "$@" --jobs "$(nproc)" ;;
esac
if [ -d build/release/python/glint_bench ]; then
  echo "Python: PYTHONPATH=$PWD/build/release/python python3, then: import glint_bench, help(glint_bench) (docs/guide/python.md)" >&2
fi
exec build/release/bin/glint-bench all "$@"
