# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the scripts of this folder with their arguments. Sets `program`, `work` and `here`, and defines `skip` and
# `require_packages`. Prints a reason and exits with 77 without Node.js.
set -euo pipefail
program="$(realpath "$1")"
work="${2:-$(mktemp -d)}"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
skip() { echo "skipped: $1"; exit 77; }

command -v node >/dev/null || skip "no node; apt-get install nodejs"
require_packages() {
  for package in "$@"; do
    [[ -d "$here/node_modules/$package" ]] || skip "no $package; npm ci --prefix tests/browser"
  done
}
