#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Benchmark history, called by the workflows in this folder for each commit of the main branch: executes the quick plan
# into a store that is shared by all commits, writes the dashboard, and lists regressions. Exit code 1 if any is open.
#   scripts/ci_example/history.sh HISTORY OUT [ACCEPTED]
# HISTORY is a persistent folder; runs stored there are not executed again. ACCEPTED is a version-controlled file of
# accepted changes: {"stillpoint_store": 2, "plans": [], "runs": [], "accepted": [{"commit": "40 digits",
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
