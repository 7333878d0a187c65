#!/usr/bin/env bash
# `all` on disks of 14 (or N) sizes, most of them too small: it says so or ends, never with a half file under a final name,
# and every fifth is given room and goes on to the same surfels: small_disks_test.sh GLINT_BENCH [N]. Needs root, for tmpfs.
set -euo pipefail
bench=$(readlink -f "$1") sizes=${2:-14}
work=$(mktemp -d /tmp/glint_disks.XXXXXX)
disk=$work/disk
mkdir "$disk"
trap 'mountpoint -q "$disk" && umount -l "$disk"; rm -rf "$work"' EXIT
mount -t tmpfs -o size=64k tmpfs "$disk" 2>/dev/null || { echo "skipped: no tmpfs can be mounted here"; exit 77; }
umount "$disk"
fail() { echo "FAILED: $*" >&2; cat "$work/err.txt" >&2; exit 1; }

all() {  # FOLDER
  "$bench" all --profile smoke --iterations 20 --device cpu --executor inline --checkpoint-seconds 0.05 \
    --data "$work/data" --out "$1" --quiet >"$work/out.txt" 2>"$work/err.txt"
}
surfels() { sha256sum <"$1/smoke/runs/room_1/2dgs/0/interface.ply" || fail "no surfels in $1"; }
# Pictures and objects that have a final name have their end, too.
whole_files() {
  local file
  while read -r file; do
    [ "$(tail -c 8 "$file" | od -An -tx1 | tr -d ' ')" = 49454e44ae426082 ] || fail "$size kB: half of $file"
  done < <(find "$disk/out" -name '[!.]*.png')
  while read -r file; do
    [ "$(tail -c 2 "$file" | tr -d ' \n')" = "}" ] || fail "$size kB: half of $file"
  done < <(find "$disk/out" -name '[!.]*.json')
}

all "$work/whole" || fail "on a disk with room"
expected=$(surfels "$work/whole")
needed=$(du -sk "$work/whole" | cut -f 1)
full=0 continued=0
for i in $(seq $sizes); do
  size=$((20 + needed * i * 7 / (sizes * 6)))
  mount -t tmpfs -o "size=${size}k" tmpfs "$disk"
  code=0; all "$disk/out" || code=$?
  case $code in
    0) ;;
    5 | 6) full=$((full + 1)); grep -qE "space|disk|written" "$work/err.txt" "$work/out.txt" || fail "$size kB: exit $code without a reason" ;;
    *) fail "$size kB: exit $code" ;;
  esac
  whole_files
  if [ $((i % 5)) -eq 0 ]; then
    mount -o remount,size=200m "$disk"
    all "$disk/out" || fail "$size kB, then room: exit $?"
    continued=$((continued + 1))
    [ "$(surfels "$disk/out")" = "$expected" ] || fail "$size kB, then room: other surfels"
    "$bench" verify --profile smoke --out "$disk/out" --data "$work/data" --quiet >"$work/out.txt" 2>"$work/err.txt" ||
      fail "$size kB, then room: verify"
  fi
  umount "$disk"
done
[ $full -ge $((sizes / 2)) ] || fail "only $full of $sizes disks were too small"
echo "$full of $sizes disks were too small; with room, $continued of them were continued, to the same surfels"
