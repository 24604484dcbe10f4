#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Formats every source file in place, or with --check only tells which are not.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

if ! command -v clang-format >/dev/null; then
  echo "format: error: clang-format is missing; run scripts/setup.sh --dev" >&2
  exit 1
fi
mode=(-i)
[[ "${1:-}" == --check ]] && mode=(--dry-run --Werror)
git ls-files -z --cached --others --exclude-standard '*.h' '*.cpp' | xargs -0 clang-format "${mode[@]}"
