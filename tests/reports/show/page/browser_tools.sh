# What tests in a browser need; exits with 77 (skipped) where it is absent. Sets CHROMIUM.
skip() {
  echo "skipped: $1; scripts/setup_extras.sh installs it"
  exit 77
}
command -v node >/dev/null || skip "no node"
[ "$(node -p 'parseInt(process.versions.node)')" -ge 20 ] || skip "node is older than 20"
[ -d "$(dirname "${BASH_SOURCE[0]}")/node_modules/playwright-core" ] || skip "no playwright-core"
CHROMIUM=$(command -v chromium || command -v chromium-browser) || skip "no chromium"
export CHROMIUM
