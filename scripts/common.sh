# SPDX-License-Identifier: BSD-3-Clause
# Shared by the scripts: sourced, not run. Leaves the shell in the root of the sources.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Objects are found again by ccache from any place of checkout.
export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1

step() { printf '\n== %s\n' "$*"; }

# configure PRESET
configure() { cmake --preset "$1" --log-level=WARNING >"$(log_file "configure-$1")" 2>&1 || show_failure "configure-$1"; }

# build PRESET TARGET...
build() {
  local preset="$1"
  shift
  local quiet=()
  [[ -t 1 ]] || quiet=(-- --quiet)
  cmake --build "build/$preset" --parallel "$(nproc)" --target "$@" "${quiet[@]}"
}

log_file() {
  mkdir -p build/logs
  echo "build/logs/$1.log"
}
show_failure() {
  cat "build/logs/$1.log" >&2
  return 1
}
