#!/usr/bin/env bash
# What the file for AVX-512 defines for the linker is its own: anything else could replace what other
# files have, on processors that cannot run it. wide_symbols_test.sh LIBRARY
set -euo pipefail
library=$1
symbols=$(nm -C --defined-only "$library" 2>/dev/null | sed -n '/^raster_wide\.cpp\.o:/,/^$/p' | grep -E ' [WVTi] ' || true)
[ -n "$symbols" ] || { echo "no raster_wide.cpp.o in $library" >&2; exit 1; }
others=$(echo "$symbols" | grep -v -e Float16 -e 'glint::kWideTiles' -e ' V DW.ref.__gxx_personality_v0' || true)
[ -z "$others" ] || { echo "defined for AVX-512, and for others too:"; echo "$others"; exit 1; } >&2
