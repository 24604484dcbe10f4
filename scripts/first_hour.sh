#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# first_hour.sh PROGRAM: runs the commands of a first hour, as README and --help show them, in an empty folder with empty
# caches, and compares each exit status with the expected one. Prints a line per command; the exit status is 1 if one differs.
set -uo pipefail
program="$(realpath "$1")"
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin" "$folder/home" "$folder/work"
ln -s "$program" "$folder/bin/stillpoint"
export PATH="$folder/bin:$PATH" HOME="$folder/home" XDG_CACHE_HOME="$folder/home/.cache"
cd "$folder/work"

failed=0 number=0
while IFS='|' read -r expected command; do
  [[ -n $command ]] || continue
  number=$((number + 1))
  start=${EPOCHREALTIME/[.,]/}
  bash -c "$command" >"$folder/out" 2>&1 </dev/null
  status=$?
  took_ms=$(((${EPOCHREALTIME/[.,]/} - start) / 1000))
  printf '%2d  %s  %6d ms  %s\n' "$number" "$([[ $status == "$expected" ]] && echo ok || echo "DIFFERS: $status")" "$took_ms" "$command"
  [[ $status == "$expected" ]] && continue
  failed=$((failed + 1))
  tail -n 20 "$folder/out"
done <<'COMMANDS'
0|stillpoint version --verbose
0|stillpoint --help
0|stillpoint help eval
0|stillpoint run --help
0|stillpoint device info
0|stillpoint config list
0|stillpoint config show
0|stillpoint config diff stillpoint dynamic_vins+vo
0|stillpoint config reference
0|stillpoint plan list
0|stillpoint plan show quick
0|stillpoint data list
0|stillpoint data catalogue tum
0|stillpoint data faults
0|stillpoint systems list
0|stillpoint data synth walking_xyz --seconds 2 --out seq
0|stillpoint data check seq
0|stillpoint run seq --out out --video video
0|stillpoint run seq --variant vo --out vo
0|stillpoint run seq --config dynamic_vins --out published
0|stillpoint run seq --fault imu_gap:start=1,duration=0.3 --out gap
0|stillpoint run walking_xyz --seconds 1 --out preset
0|stillpoint eval seq/groundtruth.txt out/trajectory.tum --plot path.svg
0|stillpoint eval seq out
0|stillpoint eval walking_xyz preset
0|stillpoint eval seq out vo published --plot all.pdf --figure all
0|stillpoint eval seq out --protocol compat:tum --protocol strict:se3 --explain
0|stillpoint eval seq out --json
0|stillpoint eval seq out --statistics --rpe-delta 0.5s --rpe-delta 5f
0|stillpoint eval seq out --find-offset
0|stillpoint eval find-protocol seq out "$(sed -n 's/.*"ate_rmse_m": \([0-9.]\{7\}\).*/\1/p' out/result.json)" --metric ATE
0|stillpoint trajectory convert out/trajectory.tum --out poses.csv
0|stillpoint eval seq poses.csv
0|stillpoint profile seq --out profile
0|stillpoint diagnose seq --budget 20s
0|stillpoint calibrate seq --out rig.toml
0|stillpoint run seq --rig rig.toml --out calibrated
0|stillpoint data export seq --layout bag --out seq.bag
0|stillpoint run seq.bag --out bag
0|stillpoint data add mine seq
0|stillpoint run mine --out mine
0|stillpoint run seq --mcap run.mcap --map-cloud map.ply --out mapped
0|stillpoint data cloud seq --out truth.ply
0|stillpoint eval cloud map.ply truth.ply --trajectory mapped/trajectory.tum --truth-trajectory seq/groundtruth.txt
0|stillpoint data cache list
0|printf '[recorded]\nsequences = ["./seq"]\nvariants = ["stillpoint", "dynamic_vins"]\n' >plan.toml
0|stillpoint bench plan.toml --store runs.sqlite
0|stillpoint bench plan.toml --store runs.sqlite
0|stillpoint bench quick --dry-run
0|stillpoint store list runs.sqlite
0|stillpoint store verify runs.sqlite
0|stillpoint store show "$(stillpoint store list runs.sqlite | awk 'NR == 1 {print $1}')" --store runs.sqlite
0|stillpoint store export base.json --numbers --store runs.sqlite
0|stillpoint store export runs.csv --tidy --store runs.sqlite
0|stillpoint stats runs.sqlite
0|stillpoint stats ablation runs.sqlite --base stillpoint
0|stillpoint compare base.json runs.sqlite
0|stillpoint report runs.sqlite --out page
0|stillpoint dashboard runs.sqlite --out dashboard
0|stillpoint regressions runs.sqlite
0|stillpoint systems new my_slam
1|stillpoint systems check my_slam.toml
2|stillpoint run walking_xzy
2|stillpoint eval seq nothing.txt
2|stillpoint store list missing.sqlite
130|timeout --signal INT 3 stillpoint run walking_halfsphere --out interrupted || (($? == 124)) && exit 130
COMMANDS
echo "$number commands, $failed with another status"
((failed == 0))
