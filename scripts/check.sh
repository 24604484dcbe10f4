#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks that must pass before a commit: format, repository rules, build, tests, sanitizers, and clang-tidy on the .cpp
# files that differ from BASE (default: main).
#   scripts/check.sh [BASE]
#   scripts/check.sh --deep   the fast, pipelined and real-time tests in a debug build and under the thread sanitizer
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

# deep PRESET: builds the fast tests and the tests of the threaded runners, and runs them
deep() {
  step "$1 build"
  configure "$1"
  build "$1" fast_tests threaded_tests
  step "fast and threaded tests of the $1 build"
  ctest --preset "$1" --label-regex '^(fast|threaded)$' --parallel "$(nproc)"
}
if [[ "${1:-}" == --deep ]]; then
  deep debug
  TSAN_OPTIONS="halt_on_error=1 suppressions=$PWD/scripts/threads.supp" deep tsan
  exit 0
fi
base="${1:-main}"

step "format"
scripts/format.sh --check

step "layers, documents, style, language, one-definition rule"
scripts/layers.sh
scripts/documents.sh
scripts/style.sh
scripts/language.sh
scripts/odr.sh

scripts/test.sh

step "clang-tidy on what differs from $base"
if ! command -v clang-tidy >/dev/null; then
  echo "check: error: clang-tidy is missing; run scripts/setup.sh --dev" >&2
  exit 1
fi
# clang reads no precompiled headers of g++ and does not know all of its warnings and options.
cmake --preset dev -B build/tidy -DSTILLPOINT_PRECOMPILE=OFF --log-level=WARNING >"$(log_file configure-tidy)" 2>&1 || show_failure configure-tidy
git diff --name-only --diff-filter=d -z "$base" -- 'core/*.cpp' 'datasets/*.cpp' 'eval/*.cpp' 'bench/*.cpp' 'reports/*.cpp' |
  xargs -0 --no-run-if-empty --max-args=4 --max-procs="$(nproc)" clang-tidy --quiet --warnings-as-errors='*' -p build/tidy \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument \
    --extra-arg=-Wno-ignored-optimization-argument
