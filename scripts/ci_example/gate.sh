#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# What the workflows beside this file run for a merge request: build base and head, judge the change on the same
# machine, and write a page about it. Exit 1 if something became worse.
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
verdict=0
build/release/stillpoint compare "$tree/build/release/stillpoint" build/release/stillpoint \
  --plan quick --pairs 5 --store "$store" --out "$out" || verdict=$?
build/release/stillpoint report "$store" --out "$out/page"
((verdict != 3)) || { echo "the change could not be judged: too few pairs or a busy machine"; exit 0; }
exit "$verdict"
