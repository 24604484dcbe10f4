# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the scripts of this folder with their arguments. Sets `program`, `work`, `here` and `browser`.
# Prints a reason and exits with 77 if no headless browser is available.
source "$(dirname "${BASH_SOURCE[0]}")/node.sh"
browser="$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)"
[[ -n "$browser" ]] || skip "no chromium; apt-get install chromium"
require_packages playwright-core
mkdir -p "$work"
