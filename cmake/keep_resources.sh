#!/usr/bin/env bash
# Compiler launcher: keep_resources.sh FILE COMMAND...: runs the compiler and moves what ptxas says of
# kernels' resources (-Xptxas -v) from its messages to FILE, which tests/cuda/resources_test.sh reads.
set -uo pipefail
file=$1
shift
messages=$("$@" 2>&1)
status=$?
of_ptxas='^(ptxas info|    [0-9]+ bytes stack frame)'
if [ $status -eq 0 ]; then grep -E "$of_ptxas" <<<"$messages" >"$file"; fi
grep -Ev "$of_ptxas|^$" <<<"$messages" >&2
exit $status
