#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the workflows beside this file run for each commit of the main branch: the quick plan into a store that is kept
# from commit to commit, the dashboard of all of them, and the list of what became worse. Exit 1 if something is open.
#   scripts/ci_example/history.sh HISTORY OUT [ACCEPTED]
# HISTORY is the folder that is kept; runs that are there are not made again. ACCEPTED is a file of changes that people
# accept, reviewed like any other: {"stillpoint_store": 1, "plans": [], "runs": [], "accepted": [{"commit": "40 digits",
# "metric": "state_optimization", "variant": "", "sequence": "", "reason": "why", "accepted": "2026-01-31T12:00:00Z"}]}
set -euo pipefail
history="$(realpath -m "$1")" out="$(realpath -m "$2")" accepted="${3:-}"
mkdir -p "$history" "$out"
cmake --preset release
cmake --build build/release --target stillpoint

store="$history/store.sqlite"
build/release/stillpoint bench quick --store "$store" --out "$out/quick"
if [[ -n "$accepted" ]]; then build/release/stillpoint store import "$accepted" --store "$store"; fi
build/release/stillpoint dashboard "$store" --out "$out/dashboard"
build/release/stillpoint regressions "$store" | tee "$out/regressions.md"
