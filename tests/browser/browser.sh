# SPDX-License-Identifier: BSD-3-Clause
# Shared by the scripts of this folder: sourced with their arguments. Sets `program`, `work`, `here` and `browser`.
# Exit 77 with a reason where a real headless browser is not to be had.
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
