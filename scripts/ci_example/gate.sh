#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Regression gate for merge requests, called by the workflows in this folder: builds base and head, compares them on the
# same machine, and writes a report. Exit status 1 if a metric is worse, 2 if nothing could be compared.
#   scripts/ci_example/gate.sh BASE_COMMIT OUT
set -euo pipefail
base="$1" out="$(realpath -m "$2")"
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
((result != 3)) || { echo "inconclusive: too few pairs or a busy machine"; exit 0; }
exit "$result"
