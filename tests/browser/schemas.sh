#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Validates JSON outputs of the program by the schemas in bench/schemas. Exits with 77 if the validator is not installed.
#   tests/browser/schemas.sh STILLPOINT [WORK]
source "$(dirname "${BASH_SOURCE[0]}")/node.sh"
require_packages ajv
schemas="$here/../../bench/schemas"

rm -rf "$work"
mkdir -p "$work"
export XDG_CACHE_HOME="$work/cache" STILLPOINT_REGISTRY="$work/sequences.json" # of this test only
for schema in "$schemas"/*.json; do mkdir "$work/$(basename "$schema" .json)"; done
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

# table KIND ALLOWED COMMAND...: a table as JSON
table() {
  local kind="$1" allowed="$2" code=0
  shift 2
  "$program" "$@" >"$work/$kind/$#.json" 2>"$work/log" || code=$?
  ((code == 0 || code == allowed)) || { cat "$work/log"; echo "exit status $code: $*"; exit 1; }
}
cp -r "$work/walking" "$work/walking_xyz"
cat >"$work/tables.toml" <<EOF_PLAN
title = "Tables"
variants = ["vo", "vo+wo_mcc"]
ablation_base = "vo"
repetitions = 2
max_frames = 8
faults = ["none", "blank:start=0.1,duration=0.1"]
expected = ["survive", "survive"]
[recorded]
sequences = ["$work/walking_xyz"]
[sweep]
frontend.max_features = [60, 90]
EOF_PLAN
runs="$work/runs.sqlite"
quiet 1 bench "$work/tables.toml" --store "$runs" --out "$work/bench"
table stats_summary 0 stats summary --store "$runs" --format json
table stats_sweep 0 stats sweep --store "$runs" --format json
table stats_ablation 0 stats ablation --store "$runs" --format json
table stats_repeat 1 stats repeat --store "$runs" --format json
table stats_repeat_with 1 stats repeat --store "$runs" --with "$runs" --format json
mkdir "$work/rendered" # `stats faults` has the rendered sequences of a plan
sed 's/^\[recorded\]/[rendered]/; s|"/.*/walking_xyz"|"walking_xyz"|' "$work/tables.toml" >"$work/rendered/tables.toml"
table stats_faults 1 stats faults --plan "$work/rendered/tables.toml" --store "$runs" --format json
table stats_imperfections 0 stats imperfections --plan tables --store "$runs" --format json
table store_list 0 store list --store "$runs" --json
build="$(node -p 'JSON.parse(require("fs").readFileSync(process.argv[1])).rows[0].build' "$(echo "$work"/store_list/*.json)")"
key="$(node -p 'JSON.parse(require("fs").readFileSync(process.argv[1])).rows[0].key' "$(echo "$work"/store_list/*.json)")"
table store_runs 0 store show "$key" --store "$runs" --json
quiet 0 store accept "$build" --metric ate_rmse_m --reason "test" --store "$runs"
table store_accepted 0 store accepted --store "$runs" --json
table plan_list 0 plan list --json
table plan_runs 0 plan show "$work/tables.toml" --json
table plan_runs 0 bench "$work/tables.toml" --dry-run --store "$runs" --json
table systems_list 0 systems list --json
quiet 0 data add walking "$work/walking"
table data_list 0 data list --json
table data_cache 0 data cache list --json
table data_catalogue 0 data catalogue --json
table data_catalogue_sequences 0 data catalogue tum --json
table data_faults 0 data faults --json
table config_diff 0 config diff stillpoint dynamic_vins --json
table config_reference 0 config reference --json
table eval_find_protocol 0 eval find-protocol "$truth" "$estimate" 0.01 --metric ATE --json

node "$here/schemas.mjs" "$schemas" "$work"
