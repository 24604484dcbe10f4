#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Relocalization from random starts: a map of the first MAP_S seconds of a sequence (`run --save-map`), then runs of RUN_S
# seconds in the rest (`run --start T --map`), T uniformly distributed with a fixed seed. Prints for each start the time from
# its first pose to the location in the map, and the largest error from there on, then the counts; false: off by more than
# 20 cm or 5 degrees. The map is aligned to the ground truth by the optimized trajectory of its run.
#   scripts/random_starts.sh FOLDER [STARTS [MAP_S [RUN_S [BUILD_FOLDER]]]]    50 starts, 32 s, 3 s, build/release
#   build/release/stillpoint data synth office_laps --out laps && scripts/random_starts.sh laps
# FOLDER: frames at 30 Hz, groundtruth.txt of the camera (rendered sequences, TUM RGB-D).
folder="$(realpath -e "${1:-}")" || { echo "usage: scripts/random_starts.sh FOLDER [STARTS [MAP_S [RUN_S [BUILD_FOLDER]]]]" >&2; exit 2; }
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
starts="${2:-50}" map_s="${3:-32}" run_s="${4:-3}" program="${5:-build/release}/stillpoint"
rate_hz=30
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

quiet() { "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }; }
run() { quiet "$program" run "$folder" --variant ablations/loop_closure --no-frame-cache "$@"; }

run --out "$work/map" --max-frames $((map_s * rate_hz)) --save-map "$work/map.bin"
echo "map of $map_s s: $(stat -c %s "$work/map.bin") bytes"
poses="$work/map/trajectory_optimized.tum"
aligned="$(grep -vc '^#' "$poses")"

# Minimal standard generator (Park and Miller, Communications of the ACM 31, 1988): the same starts with every awk.
awk -v n="$starts" -v from=$((map_s + 1)) -v run_s="$run_s" '
  /^#/ { next }
  !first { first = $1 }
  { last = $1 }
  END {
    to = last - first - run_s
    if (to <= from) { print "random_starts: error: the sequence is too short" >"/dev/stderr"; exit 2 }
    for (x = 12345; n > 0; --n) { x = (16807 * x) % 2147483647; printf "%.2f\n", from + (to - from) * x / 2147483647 }
  }' "$folder/groundtruth.txt" >"$work/starts"

while read -r start; do
  run --out "$work/run" --start "$start" --max-frames $((run_s * rate_hz)) --map "$work/map.bin"
  time_s="$(sed -n 's/.*"relocalization_s": \([0-9.e+-]*\),*$/\1/p' "$work/run/result.json")"
  [[ -n "$time_s" ]] || { echo "$start s: not located"; continue; }
  grep -hv '^#' "$poses" "$work/run/trajectory_loop.tum" >"$work/both.tum"
  quiet "$program" eval "$folder/groundtruth.txt" "$work/both.tum" --protocol compat:tum --align se3 \
    --align-first "$aligned" --per-pose "$work/errors.csv" --force
  awk -F, -v start="$start" -v time_s="$time_s" -v skipped=$((aligned + 1)) '
    NR <= skipped { next }
    $4 > m { m = $4 }
    $5 > deg { deg = $5 }
    END { printf "%s s: located after %.2f s, off by at most %.3f m and %.2f deg\n", start, time_s, m, deg }' "$work/errors.csv"
done <"$work/starts" | tee "$work/results"

awk '/located after/ {
    ++located
    if ($5 <= 1 && $11 <= 0.05 && $14 <= 2) ++soon
    if ($5 > slowest) slowest = $5
    if ($11 > m) m = $11
    if ($14 > deg) deg = $14
    if ($11 > 0.2 || $14 > 5) ++wrong
  }
  END {
    printf "%d of %d starts located, %d within 1 s, 5 cm and 2 deg; slowest %.2f s; at most %.3f m and %.2f deg; %d false\n", located, NR, soon, slowest, m, deg, wrong
  }' "$work/results"
