#!/usr/bin/env bash
# Downloads the published weights of LPIPS 0.1, checks their sums and converts them for glint-bench and glint-lpips:
#   scripts/fetch_lpips_weights.sh [--out FOLDER] [--downloads FOLDER] [alex] [vgg]
# Without a name: both. VGG16's file has 528 MB, AlexNet's 233 MB. FOLDER is by default where they are looked
# for: $GLINT_LPIPS_WEIGHTS, else ~/.cache/glint-bench/lpips. Files that lie in the folder of downloads already (fetched on another
# machine, say) are taken. Without a network it says which file to put where, and exits with 6.
# Licences: the linear layers BSD-2-Clause (R. Zhang et al., PerceptualSimilarity), the networks BSD-3-Clause
# (torchvision; trained on ImageNet, whose pictures are for research). Neither is part of GLINT Bench.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
out=${GLINT_LPIPS_WEIGHTS:-${XDG_CACHE_HOME:-$HOME/.cache}/glint-bench/lpips} downloads= nets=()
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$2; shift 2 ;;
    --downloads) downloads=$2; shift 2 ;;
    alex | vgg) nets+=("$1"); shift ;;
    *) sed -n '2,8s/^# \{0,1\}//p' "$0" >&2; exit 1 ;;
  esac
done
[ ! -f "$out" ] || out=$(dirname "$out")
[ ${#nets[@]} -gt 0 ] || nets=(alex vgg)
downloads=${downloads:-$out/downloads}
command -v python3 >/dev/null || { echo "fetch_lpips_weights: python3 is missing" >&2; exit 6; }

networks=${GLINT_LPIPS_NETWORKS:-https://download.pytorch.org/models}
linear=${GLINT_LPIPS_LINEAR:-https://raw.githubusercontent.com/richzhang/PerceptualSimilarity/master/lpips/weights/v0.1}
features_of() {
  case $1 in
    alex) echo alexnet-owt-7be5be79.pth ;;
    vgg) echo vgg16-397923af.pth ;;
  esac
}
missing=()
# get URL FILE: unless it is there; whole or not at all.
get() {
  [ -s "$downloads/$2" ] && return 0
  echo "$1" >&2
  if curl -fL -# --connect-timeout 20 -o "$downloads/$2.part" "$1"; then
    mv "$downloads/$2.part" "$downloads/$2"
  else
    rm -f "$downloads/$2.part"
    missing+=("$1  ->  $downloads/$2")
  fi
}

mkdir -p "$downloads"
command -v curl >/dev/null || curl() { echo "curl is missing" >&2; return 1; }
for net in "${nets[@]}"; do
  features=$(features_of "$net")
  get "$networks/$features" "$features"
  get "$linear/$net.pth" "$net.pth"
  [ -s "$downloads/$features" ] && [ -s "$downloads/$net.pth" ] || continue
  "$root/scripts/convert_lpips_weights.py" --net "$net" --features "$downloads/$features" --lin "$downloads/$net.pth" --out "$out"
done
[ ${#missing[@]} -eq 0 ] && exit 0
{
  echo "fetch_lpips_weights: not fetched; put these files there by hand and run this again (converted files go to $out):"
  printf '  %s\n' "${missing[@]}"
} >&2
exit 6
