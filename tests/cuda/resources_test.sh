#!/usr/bin/env bash
# resources_test.sh FILE TABLE: what each kernel takes of a multiprocessor, from ptxas' words
# (cmake/keep_resources.sh). Writes a table; fails where a kernel spills registers or has a larger
# frame in local memory than it may.
set -euo pipefail

# Largest frames, bytes. Local memory is device memory: large kernels may have none. A kernel that is
# not named here may have one of 256 bytes, if it is small.
limits='
ForwardTile 0
BackwardTile 0
SumSlots 0
SumRows 0
SurfelVjp 0
ProjectSurfels 0
WritePairs 0
FindHits 0
CompositeRays 0
BackwardRays 0
SumWindows 0
GatherSurfels 0
ConvolveTile 0
FirstSurface 2560 (list of all hits; of masked pixels, in one method)
DepthModesOfPixel 2560 (the same list; of renders, not of training)
'

table() {  # kernel, arch, registers, shared memory, frame, spills
  awk -F"'" '/Compiling entry function/ { name = $2; arch = $4 }
    /bytes stack frame/ { split($0, n, /[^0-9]+/); frame = n[2]; spills = n[3] + n[4] }
    /Used [0-9]+ registers/ {
      match($0, /Used [0-9]+/); registers = substr($0, RSTART + 5, RLENGTH - 5)
      shared = match($0, /[0-9]+ bytes smem/) ? substr($0, RSTART, RLENGTH - 11) : 0
      print name, arch, registers, shared, frame, spills }' "$1" |
    c++filt | grep -v 'cub::' | sed -E 's/\(anonymous namespace\):://g; s/glint::(gpu::)?//g' |
    sed -E 's/^void run_(blocks|elements)<//; s/ ?>\([^()]*\) / /; s/, /,/g; s/ >/>/g' | LC_ALL=C sort -u
}

check() {  # of a table; prints what is wrong
  awk -v limits="$limits" '
    BEGIN { count = split(limits, lines, "\n")
      for (i = 1; i <= count; ++i) if (split(lines[i], w, " ") > 1) { limit[w[1]] = w[2]; there[w[1]] = 0 } }
    { name = $1; sub(/<.*/, "", name); there[name] = 1
      most = name in limit ? limit[name] : 256
      if ($5 > most) { print $1 " (" $2 ") has a frame of " $5 " bytes, of at most " most; bad = 1 }
      if ($6 > 0) { print $1 " (" $2 ") spills registers"; bad = 1 } }
    END { for (name in limit) if (!there[name]) { print name ": no such kernel"; bad = 1 }; exit bad }' "$1"
}

table "$1" >"$2.rows"
{
  echo '| kernel | for | registers | shared, bytes | frame, bytes | spills, bytes |'
  echo '|---|---|---:|---:|---:|---:|'
  awk '{ print "| `" $1 "` | " $2 " | " $3 " | " $4 " | " $5 " | " $6 " |" }' "$2.rows"
} >"$2"
cat "$2"

# The check can fail.
for wrong in 's/^(ForwardTile.*) 0 0$/\1 8 0/' 's/^(SumRows.*) 0 0$/\1 0 4/' 's/^BackwardTile/Renamed/'; do
  if sed -E "$wrong" "$2.rows" | check - >/dev/null; then
    echo "not noticed: $wrong" >&2
    exit 1
  fi
done
check "$2.rows"
