#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Regression gate for merge requests, called by the workflows in this folder: builds base and head, compares them on the
# same machine, and writes a report. Exit status 1 if a metric is worse or missing, 2 if nothing could be compared, 3 if the
# comparison is inconclusive (too few pairs, a busy machine); 0 instead of 3 with --allow-inconclusive.
#   scripts/ci_example/gate.sh BASE_COMMIT OUT [--allow-inconclusive]
set -euo pipefail
base="$1" out="$(realpath -m "$2")" option="${3:-}"
tree="$(mktemp -d)"
trap 'git worktree remove --force "$tree"' EXIT
mkdir -p "$out"

build() { cmake --preset release && cmake --build build/release --target stillpoint; }
git worktree add --detach "$tree" "$base"
(cd "$tree" && build)
build

store="$out/store.sqlite"
result=0
build/release/stillpoint compare "$tree/build/release/stillpoint" build/release/stillpoint \
  --plan quick --store "$store" --out "$out" || result=$?
build/release/stillpoint report "$store" --out "$out/page"
if grep -qs '<error' "$out/compare.xml"; then exit 2; fi
if ((result == 3)) && [[ "$option" == --allow-inconclusive ]]; then exit 0; fi
exit "$result"
