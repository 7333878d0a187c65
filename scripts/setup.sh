#!/usr/bin/env bash
# Installs the Debian packages that GLINT Bench builds and tests with: components used, no recommends.
# Idempotent. As root (or with passwordless sudo) it installs; otherwise it says what is missing.
set -euo pipefail

packages=(
  g++ cmake ninja-build ccache git ca-certificates pkg-config
  libembree-dev libopenexr-dev libnanoflann-dev libeigen3-dev libcli11-dev catch2 libtbb-dev
  nlohmann-json3-dev libtomlplusplus-dev libfmt-dev libbullet-dev
  libopencv-core-dev libopencv-imgproc-dev libopencv-calib3d-dev libturbojpeg0-dev libdeflate-dev libwebp-dev libtiff-dev libyaml-cpp-dev
  libcairo2-dev libpango1.0-dev fonts-inter
  libassimp-dev libpng-dev nettle-dev libdnnl-dev libcgal-dev libopen3d-dev
  python3-dev python3-numpy pybind11-dev
  clang-format-14
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "setup: all ${#packages[@]} packages are installed" >&2
  exit 0
fi

if ! command -v apt-get >/dev/null; then
  echo "setup: this is not Debian or Ubuntu; install the equivalents of: ${missing[*]}" >&2
  exit 6
fi
run=()
if [ "$(id -u)" -ne 0 ]; then
  if sudo -n true 2>/dev/null; then
    run=(sudo)
  else
    echo "setup: missing packages; run as root:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 6
  fi
fi
echo "setup: installing ${missing[*]}" >&2
export DEBIAN_FRONTEND=noninteractive
"${run[@]}" apt-get update -qq
"${run[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
echo "setup: done" >&2
