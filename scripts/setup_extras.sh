#!/usr/bin/env bash
# What three tests need that are skipped without: Chromium, Node.js and playwright-core (the report
# page in a browser), TeX Live (all tables in one PDF), Slurm (a profile on a cluster of one node);
# and matplotlib, for an example of the Python module. Idempotent; root (or passwordless sudo) for
# the Debian packages.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=()
command -v chromium >/dev/null || packages+=(chromium fonts-dejavu-core)
command -v node >/dev/null || packages+=(nodejs)
command -v npm >/dev/null || packages+=(npm)
[ -x /usr/sbin/slurmctld ] || packages+=(slurm-wlm)
# texlive: has booktabs, colortbl and xcolor; lmodern: letters that stay sharp, otherwise they are pixels.
for package in texlive-latex-recommended lmodern python3-matplotlib; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || packages+=("$package")
done
if [ ${#packages[@]} -gt 0 ]; then
  run=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! sudo -n true 2>/dev/null; then
      echo "setup_extras: missing packages; run as root:" >&2
      echo "  apt-get install --no-install-recommends ${packages[*]}" >&2
      exit 6
    fi
    run=(sudo)
  fi
  echo "setup_extras: installing ${packages[*]}" >&2
  export DEBIAN_FRONTEND=noninteractive
  "${run[@]}" apt-get update -qq
  "${run[@]}" apt-get install -y -qq --no-install-recommends "${packages[@]}" >/dev/null
fi
cd tests/reports/show/page
[ node_modules/.package-lock.json -nt package-lock.json ] || npm ci --silent --no-audit --no-fund
echo "setup_extras: done" >&2
