#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the workflows beside this file run for each commit of the main branch: the quick plan into a store that is kept
# from commit to commit, the dashboard of all of them, and the list of what became worse. Exit 1 if something is open.
#   scripts/ci_example/history.sh HISTORY OUT
# HISTORY is the folder that is kept; runs that are there are not made again.
set -euo pipefail
history="$(realpath -m "$1")" out="$(realpath -m "$2")"
mkdir -p "$history" "$out"
cmake --preset release
cmake --build build/release --target stillpoint

store="$history/store.sqlite"
build/release/stillpoint bench quick --store "$store" --out "$out/quick"
build/release/stillpoint dashboard "$store" --out "$out/dashboard"
build/release/stillpoint regressions "$store" | tee "$out/regressions.md"
