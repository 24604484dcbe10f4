# SPDX-License-Identifier: BSD-3-Clause
# Shared by the tests of the scripts: sourced with ROOT and SCRATCH as arguments.
set -euo pipefail
root="$1"
scratch="$2"
failures=0

fail() {
  echo "FAILED: $1"
  failures=$((failures + 1))
}
# Starts with an empty source tree: the folders that the checkers read.
empty_tree() {
  rm -rf "$scratch"
  mkdir -p "$scratch"/{core,datasets,eval,bench,reports,tests}
}
# put PATH TEXT: writes a file of the tree
put() {
  mkdir -p "$(dirname "$scratch/$1")"
  printf '%s\n' "$2" >"$scratch/$1"
}
# expect_clean SCRIPT WHAT
expect_clean() {
  local output
  output="$("$root/scripts/$1" "$scratch" 2>&1)" || fail "$2 is refused: $output"
}
# expect_fault SCRIPT TEXT WHAT: the script fails and its output holds TEXT
expect_fault() {
  local output
  if output="$("$root/scripts/$1" "$scratch" 2>&1)"; then
    fail "$3 is not seen"
  elif [[ "$output" != *"$2"* ]]; then
    fail "$3: expected \"$2\" in: $output"
  fi
}
finish() {
  ((failures == 0)) || exit 1
  echo "all as expected"
}
