#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Records a run with `run --mcap`, and one of a store with `store extract --mcap`, and reads the files with the packages of the MCAP and Foxglove projects. Exits with 77 if
# they are not installed.
#   tests/browser/mcap.sh STILLPOINT [WORK]
source "$(dirname "${BASH_SOURCE[0]}")/node.sh"
require_packages @mcap/core @mcap/support @foxglove/schemas ajv

rm -rf "$work"
mkdir -p "$work"
"$program" data synth walking_xyz --width 320 --height 240 --focal 210 --seconds 2 --out "$work/walking" >"$work/synth.log" 2>&1
run() {
  name="$1"
  shift
  "$program" run "$work/walking" --out "$work/$name" --mcap "$work/$name.mcap" --dump labels "$@" >"$work/$name.log" 2>&1
}
run plain
run images --mcap-images --variant ablations/loop_closure
MCAP="$work/plain.mcap" RUN="$work/plain" SEQUENCE="$work/walking" node "$here/mcap.mjs"
MCAP="$work/images.mcap" RUN="$work/images" SEQUENCE="$work/walking" IMAGES=1 node "$here/mcap.mjs"

cat >"$work/plan.toml" <<END
title = "Stored"
variants = ["stillpoint"]
images = 3
[recorded]
sequences = ["$work/walking"]
END
"$program" bench "$work/plan.toml" --store "$work/store.sqlite" --out "$work/bench" >"$work/bench.log" 2>&1
key="$("$program" store list "$work/store.sqlite" | awk 'NR == 1 { print $1 }')"
"$program" store extract "$key" "$work/stored" --mcap --store "$work/store.sqlite" | grep -q "not in the store: inertial samples"
MCAP="$work/stored/run.mcap" RUN="$work/stored" STORED=1 node "$here/mcap.mjs"
