# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the scripts of this folder with their arguments. Sets `program`, `work`, `here` and `browser`.
# Prints a reason and exits with 77 if no headless browser is available.
set -euo pipefail
program="$(realpath "$1")"
work="${2:-$(mktemp -d)}"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
skip() { echo "skipped: $1"; exit 77; }

command -v node >/dev/null || skip "no node; apt-get install nodejs"
browser="$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)"
[[ -n "$browser" ]] || skip "no chromium; apt-get install chromium"
[[ -d "$here/node_modules/playwright-core" ]] || skip "no playwright-core; npm ci --prefix tests/browser"
mkdir -p "$work"
