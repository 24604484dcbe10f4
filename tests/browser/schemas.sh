#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Validates JSON outputs of the program by the schemas in bench/schemas. Exits with 77 if the validator is not installed.
#   tests/browser/schemas.sh STILLPOINT [WORK]
source "$(dirname "${BASH_SOURCE[0]}")/node.sh"
require_packages ajv
schemas="$here/../../bench/schemas"

rm -rf "$work"
mkdir -p "$work"/{result,eval,compare,store_export,device_info}
# quiet ALLOWED COMMAND...: exit status 0 or ALLOWED, output to a log
quiet() {
  local allowed="$1" code=0
  shift
  "$program" "$@" >"$work/log" 2>&1 || code=$?
  ((code == 0 || code == allowed)) || { cat "$work/log"; echo "exit status $code: $*"; exit 1; }
}
run() {
  local name="$1" allowed="$2"
  shift 2
  quiet "$allowed" run "$work/walking" --out "$work/$name" "$@"
  cp "$work/$name/result.json" "$work/result/$name.json"
}
quiet 0 data synth walking_xyz --width 320 --height 240 --focal 210 --seconds 1 --labels --out "$work/walking"
run vo 0 --variant vo
run realtime 0 --mode realtime --imu-rate
run fault 1 --fault blank:start=0.3,duration=0.2
run loops 0 --variant ablations/loop_closure
run lost 1 --max-frames 1

truth="$work/walking/groundtruth.txt"
estimate="$work/vo/trajectory.tum"
evaluate() {
  local name="$1" code=0
  shift
  "$program" eval "$truth" "$@" --json >"$work/eval/$name.json" 2>"$work/log" || code=$?
  ((code <= 1)) || { cat "$work/log"; exit 1; }
}
evaluate one "$estimate"
evaluate several "$estimate" "$work/realtime/trajectory.tum" --protocol compat:tum --protocol strict:se3 --protocol compat:rpg
evaluate meters "$estimate" --rpe-unit m --rpe-delta 0.1 --align yaw
evaluate intervals "$estimate" --rpe-delta 0.2 --rpe-delta 5deg --rpe-delta 0.1m
head -n 3 "$estimate" >"$work/short.tum"
evaluate short "$work/short.tum"

baseline="$here/../../bench/baselines/quick_instructions.json"
sed 's/"value": 1/"value": 2/' "$baseline" >"$work/head.json"
quiet 1 compare "$baseline" "$work/head.json" --out "$work/comparison"
cp "$work/comparison/compare.json" "$work/compare/worse.json"
quiet 0 store import "$baseline" --store "$work/store.sqlite"
quiet 0 store export "$work/store_export/numbers.json" --numbers --store "$work/store.sqlite"
quiet 0 store export "$work/store_export/all.json" --store "$work/store.sqlite"
"$program" device info --json >"$work/device_info/this.json"
node "$here/schemas.mjs" "$schemas" "$work"
