#!/usr/bin/env bash
# Whether every source stands as .clang-format has it; `scripts/check_format.sh --mend` makes it so. Looks at tracked files and at new
# ones that git does not ignore. Exit 77 (skipped) outside a git checkout.
set -euo pipefail
cd "$(dirname "$0")/.."
git rev-parse --git-dir >/dev/null 2>&1 || { echo "skipped: not a git checkout" >&2; exit 77; }
how=(--dry-run --Werror)
[ "${1:-}" != --mend ] || how=(-i)
git ls-files -z --cached --others --exclude-standard '*.h' '*.cpp' '*.cu' '*.cuh' |
  xargs -0 clang-format-14 "${how[@]}"
