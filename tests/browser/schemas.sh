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
quiet 0 data synth walking_xyz --width 320 --height 240 --focal 210 --seconds 1.5 --labels --out "$work/walking"
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

# output KIND ALLOWED COMMAND...: what a command prints
outputs=0
output() {
  local kind="$1" allowed="$2" code=0
  shift 2
  outputs=$((outputs + 1))
  "$program" "$@" >"$work/$kind/$outputs.json" 2>"$work/log" || code=$?
  ((code == 0 || code == allowed)) || { cat "$work/log"; echo "exit status $code: $*"; exit 1; }
}

# Three poses on a line, of which one is a centimeter off, and a cloud of them.
mkdir -p "$work/openloris/mine"
for file in truth/gt_cafe_1 openloris/mine/cafe-1-1; do
  mkdir -p "$(dirname "$work/$file")"
  { printf 'scene: cafe\nseq: 1\n'; for i in {1..30}; do echo "$i 0.$i 0 0 0 0 0 1"; done; } >"$work/$file.txt"
done
output eval_openloris 0 eval openloris "$work/openloris" --ground-truth "$work/truth" --json
for z in 0 0.01; do
  printf 'ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n' >"$work/cloud$z.ply"
  printf "%s 0 $z\n" 0 1 2 >>"$work/cloud$z.ply"
done
output eval_cloud 0 eval cloud "$work/cloud0.ply" "$work/cloud0.01.ply" --json

baseline="$here/../../bench/baselines/quick_instructions.json"
sed 's/"value": 1\([0-9]\)/"value": 2\1/' "$baseline" >"$work/head.json" # counts, not fractions
quiet 1 compare "$baseline" "$work/head.json" --out "$work/comparison"
cp "$work/comparison/compare.json" "$work/compare/worse.json"
output compare 1 compare "$baseline" "$work/head.json" --json
cmp "$work/compare/worse.json" "$work/compare/$outputs.json"
quiet 0 store import "$baseline" --store "$work/store.sqlite"
quiet 0 store export "$work/store_export/numbers.json" --numbers --store "$work/store.sqlite"
quiet 0 store export "$work/store_export/all.json" --store "$work/store.sqlite"
output device_info 0 device info --json
node "$here/history_store.mjs" >"$work/history.json"
quiet 0 store import "$work/history.json" --store "$work/history.sqlite"
output regressions 1 regressions "$work/history.sqlite" --format json

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
cp "$work/bench/table.json" "$work/bench_table/table.json"
cp "$work/bench/profile.json" "$work/bench_profile/profile.json"
output stats_summary 0 stats summary --store "$runs" --format json
output stats_sweep 0 stats sweep --store "$runs" --format json
output stats_ablation 0 stats ablation --store "$runs" --format json
output stats_repeat 1 stats repeat --store "$runs" --format json
output stats_repeat_with 1 stats repeat --store "$runs" --with "$runs" --format json
output stats_faults 1 stats faults --plan "$work/tables.toml" --store "$runs" --format json
output stats_imperfections 0 stats imperfections --plan tables --store "$runs" --format json
output store_list 0 store list --store "$runs" --json
build="$(node -p 'JSON.parse(require("fs").readFileSync(process.argv[1])).rows[0].build' "$(echo "$work"/store_list/*.json)")"
key="$(node -p 'JSON.parse(require("fs").readFileSync(process.argv[1])).rows[0].key' "$(echo "$work"/store_list/*.json)")"
output store_runs 0 store show "$key" --store "$runs" --json
quiet 0 store accept "$build" --metric ate_rmse_m --reason "test" --store "$runs"
output store_verify 0 store verify --store "$runs" --json
output store_differences 1 store verify --equal "$runs" "$work/store.sqlite" --json
output store_accepted 0 store accepted --store "$runs" --json
output plan_list 0 plan list --json
output plan_runs 0 plan show "$work/tables.toml" --json
output plan_runs 0 bench "$work/tables.toml" --dry-run --store "$runs" --json
output bench_estimate 0 bench "$work/tables.toml" --estimate --store "$work/none.sqlite" --tasks 3 --workers 2 --json
output systems_list 0 systems list --json
quiet 0 data add walking "$work/walking"
output data_list 0 data list --json
output data_cache 0 data cache list --json
output data_catalogue 0 data catalogue --json
output data_catalogue_sequences 0 data catalogue tum --json
output data_faults 0 data faults --json
rm "$work/walking/aligned_depth/$(ls "$work/walking/aligned_depth" | tail -n 1)" # a finding
output data_check 1 data check "$work/walking" --json
output config_list 0 config list --json
output config_diff 0 config diff stillpoint dynamic_vins --json
output config_reference 0 config reference --json
output eval_find_protocol 0 eval find-protocol "$truth" "$estimate" 0.01 --metric ATE --json

output diagnose 1 diagnose "$work/walking_xyz" --budget 20s --json
output calibrate 0 calibrate "$work/walking_xyz" --json
profile() { quiet 0 profile "$work/walking_xyz" --out "$work/profiles" --max-frames "$@"; }
profile 8
cp "$work/profiles/profile.json" "$work/profile/once.json"
profile 8 --duration 1s
cp "$work/profiles/profile.json" "$work/profile/drift.json"
profile 30 --device atlas_200
cp "$work/profiles/device.json" "$work/device/atlas.json"
command -v valgrind >/dev/null || skip "no valgrind; apt-get install valgrind"
profile 2 --instructions
cp "$work/profiles/instructions.json" "$work/instructions/two.json"

node "$here/schemas.mjs" "$schemas" "$work"
