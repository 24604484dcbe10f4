#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What must pass before a commit: format, the ground rules, build, tests, sanitizers, and clang-tidy on the .cpp files
# that differ from the branch or commit given (default: main).
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
base="${1:-main}"

step "format"
scripts/format.sh --check

step "layers, paper map, style"
scripts/layers.sh
scripts/paper_map.sh
scripts/style.sh

scripts/test.sh

step "clang-tidy on what differs from $base"
if ! command -v clang-tidy >/dev/null; then
  echo "check: error: clang-tidy is missing; run scripts/setup.sh --dev" >&2
  exit 1
fi
git diff --name-only --diff-filter=d -z "$base" -- 'core/*.cpp' 'datasets/*.cpp' 'eval/*.cpp' 'bench/*.cpp' 'reports/*.cpp' |
  xargs -0 --no-run-if-empty --max-args=4 --max-procs="$(nproc)" clang-tidy --quiet --warnings-as-errors='*' -p build/release
