#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Calibrates random rigs (`--fault rig:seed=N`, see datasets/faults/rig_faults.h) on rendered sequences, and compares
# the estimates with the exact calibration: CSV with the columns sequence, seed, parameter, unit, error, sigma,
# stated_error, outcome. Then prints per parameter, of those that the recordings observed: their number, the ratio
# within 3 claimed deviations, the mean normalized squared error (NEES), and medians of |error|, of the deviation and of
# the error of the stated values.
#   scripts/calibration_rigs.sh PROGRAM TABLE.csv SEEDS SEQUENCE...     SEEDS such as "1 2 3"; "" prints TABLE.csv only;
#                                                                       SEQUENCE: folders
# Of the imperfections of the sensors, depth_scaled, time_offset, gyro_scale, accel_scale and imu_misalignment change true
# values, depth_bias and depth_shift those of the depth; the others (noise, blur, g-sensitivity) are in no parameter. The
# time offset is compared with its mean over the recording, as the clock drifts.
set -euo pipefail
program="$1" table="$2" seeds="$3"
shift 3
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

keep=()
for name in focal center distortion rolling_shutter depth_scale depth_offset depth_intrinsics depth_pose extrinsics time_offset imu_intrinsics; do
  keep+=(--keep "$name")
done

amount() { # FAULT: its amount in the manifest of a run
  grep -o "\"$1:[^\"]*amount=[^,\"]*" "$work/run/manifest.json" | sed 's/.*amount=//'
}

mix_bits() { # NUMBER: core/base/content_hash.h
  local x=$(($1 + 0x9e3779b97f4a7c15))
  x=$(((x ^ ((x >> 30) & 0x3ffffffff)) * 0xbf58476d1ce4e5b9))
  x=$(((x ^ ((x >> 27) & 0x1fffffffff)) * 0x94d049bb133111eb))
  echo $((x ^ ((x >> 31) & 0x1ffffffff)))
}

signs() { # FAULT DRAW...: the random signs of its seed, by their number (RandomSequence, stream 11)
  local seed key draw
  seed="$(grep -o "\"$1:[^\"]*seed=[0-9]*" "$work/run/manifest.json" | sed 's/.*seed=//')"
  shift
  key="$(mix_bits "$(mix_bits $((seed ^ (11 << 56))))")"
  for draw in "$@"; do
    (($(mix_bits $((key + draw * 0xd1342543de82ef95))) >= 0)) && echo 1 || echo -1
  done
}

# "NAME VALUE" of the axes of the inertial sensors: (I + N) (I + S), see datasets/faults/inertial_faults.h.
true_axes() {
  paste -d ' ' <(signs gyro_scale 0 4 8 0 4 8) <(signs accel_scale 0 4 8 0 4 8) \
    <(printf '0\n0\n0\n' && signs imu_misalignment 1 2 5) <(printf '0\n0\n0\n' && signs imu_misalignment 10 11 14) |
    awk -v gyro="$(amount gyro_scale)" -v accel="$(amount accel_scale)" -v angle="$(amount imu_misalignment)" '
      { g[NR] = $1 * gyro; a[NR] = $2 * accel; G[NR] = $3 * angle; A[NR] = $4 * angle }
      END {
        split("x y z xy xz yz", name, " "); column[4] = 2; column[5] = column[6] = 3
        for (i = 1; i <= 3; ++i) print "gyro scale " name[i] "," g[i] "\naccel scale " name[i] "," a[i]
        for (i = 4; i <= 6; ++i)
          print "gyro axes " name[i] "," G[i] * (1 + g[column[i]] / 100) "\naccel axes " name[i] "," \
            A[i] * (1 + a[column[i]] / 100)
      }'
}

# "X Y": displacement of the depth images in whole pixels, see datasets/faults/image_faults.cpp.
depth_shift() {
  local seed key
  seed="$(grep -o "\"depth_shift:[^\"]*seed=[0-9]*" "$work/run/manifest.json" | sed 's/.*seed=//')"
  key="$(mix_bits "$(mix_bits $((seed ^ (11 << 56))))")"
  awk -v pixels="$(amount depth_shift)" -v bits=$((($(mix_bits "$key") >> 11) & 0x1fffffffffffff)) '
    BEGIN { angle = bits / 2 ^ 53 * 6.283185307179586; printf "%.0f %.0f", pixels * cos(angle), pixels * sin(angle) }'
}

seconds() { # SEQUENCE: from its first image to the last one
  { "$program" data check "$1" --json || true; } | awk '/"last_s":/ { print $2 + 0; exit }'
}

compare() { # SEQUENCE SEED SECONDS: rows of the table from axes.csv, true.toml, found.toml and found.json
  awk -v sequence="$1" -v seed="$2" -v scale="$(amount depth_scaled)" -v offset="$(amount time_offset)" \
    -v bias="$(amount depth_bias)" -v shift="$(depth_shift)" -v drift_ppm="$(amount clock_drift)" -v seconds="$3" '
    BEGIN { split(shift, pixels, " "); truth["depth shift x"] = pixels[1]; truth["depth shift y"] = pixels[2]
            truth["depth offset"] = -bias }
    function numbers(text) { gsub(/[][,]/, " ", text); sub(/#.*/, "", text); return text }
    FILENAME ~ /csv$/ { split($0, axis_of, ","); truth[axis_of[1]] = axis_of[2]; next }
    FILENAME ~ /toml$/ && / = / {
      which = FILENAME ~ /true.toml$/ ? "true" : "found"
      if ($1 == "T_b_c") { sub(/.*= /, ""); split(numbers($0), m, " "); for (i in m) T[which, i] = m[i]; next }
      if ($1 == "distortion") { sub(/.*= /, ""); split(numbers($0), k, " "); truth["k1"] = which == "true" ? k[1] : truth["k1"]
                                truth["k2"] = which == "true" ? k[2] : truth["k2"]; next }
      if (which == "true") truth[$1] = $3
      next
    }
    /"name":/ { name = $0; sub(/.*: "/, "", name); sub(/".*/, "", name) }
    /"unit":/ { unit = $0; sub(/.*: "/, "", unit); sub(/".*/, "", unit) }
    /"value":/ { value = $2 + 0 }
    /"sigma":/ { sigma = $2 + 0 }
    /"stated":/ { stated = $2 + 0 }
    /"outcome":/ {
      outcome = $2; gsub(/[",]/, "", outcome)
      degrees = 57.29577951308232
      axis = name ~ / x$/ ? 1 : name ~ / y$/ ? 2 : 3
      if (name ~ /T_b_c rotation/) {  # log(R_found^T R_true), and the same of the stated one by the estimated turn
        a = axis % 3 + 1; b = a % 3 + 1; element = 0
        for (row = 0; row < 3; ++row)
          element += T["found", 4 * row + b] * T["true", 4 * row + a] - T["found", 4 * row + a] * T["true", 4 * row + b]
        error = -0.5 * element * degrees; wrong = value - error; wrong = -wrong
      } else {
        right = name ~ /^T_b_c/ ? 1000 * T["true", 4 * axis] : name == "depth scale" ? scale : \
                name == "time_offset_s" ? 1000 * (truth[name] + offset) + 1e-3 * drift_ppm * seconds / 2 : name == "rolling_shutter_s" ? 1000 * truth[name] : truth[name]
        error = value - right; wrong = stated - right
      }
      printf "%s,%s,%s,%s,%.6g,%.6g,%.6g,%s\n", sequence, seed, name, unit, error, sigma, wrong, outcome
    }' "$work/axes.csv" "$work/true.toml" "$work/found.toml" "$work/found.json"
}

[[ -e "$table" ]] || echo "sequence,seed,parameter,unit,error,sigma,stated_error,outcome" >"$table"
for seed in $seeds; do
  for sequence in "$@"; do
    name="$(basename "$sequence")"
    rm -rf "${work:?}"/*
    "$program" calibrate "$sequence" --max-frames 60 "${keep[@]}" --out "$work/true.toml" >/dev/null 2>&1 || true
    "$program" run "$sequence" --fault "rig:seed=$seed" --max-frames 40 --out "$work/run" >/dev/null 2>&1 || true
    if "$program" calibrate "$sequence" --fault "rig:seed=$seed" --json --out "$work/found.toml" \
      >"$work/found.json" 2>"$work/err"; then
      true_axes >"$work/axes.csv"
      compare "$name" "$seed" "$(seconds "$sequence")" >>"$table"
    else
      echo "$name,$seed,,,,,,failed: $(tail -n 1 "$work/err" | tr ',' ';')" >>"$table"
    fi
  done
done

# Medians need sorted values: one pass per parameter.
printf '%-18s %8s %9s %8s %6s %9s %9s %9s\n' parameter rigs observed within_3 NEES error deviation stated
tail -n +2 "$table" | cut -d, -f3 | sort -u | while IFS= read -r parameter; do
  [[ -n "$parameter" ]] || continue
  median() { # COLUMN of the observed rows
    awk -F, -v p="$parameter" -v c="$1" '$3 == p && $8 != "not_observed" { v = $c < 0 ? -$c : $c + 0; print v }' "$table" |
      sort -g | awk '{ v[NR] = $1 } END { if (NR) printf "%.3g", v[int((NR + 1) / 2)]; else printf "n/a" }'
  }
  awk -F, -v p="$parameter" -v error="$(median 5)" -v sigma="$(median 6)" -v stated="$(median 7)" '
    $3 == p { all++; unit = $4; if ($8 != "not_observed") { n++; z = $5 / $6; squares += z * z; within += z * z <= 9 } }
    END { printf "%-18s %8d %9d %8s %6s %9s %9s %9s %s\n", p, all, n, n ? sprintf("%.3f", within / n) : "n/a",
          n ? sprintf("%.2f", squares / n) : "n/a", error, sigma, stated, unit }' "$table"
done
awk -F, '$3 != "" && $8 != "not_observed" && NR > 1 { z = $5 / $6; n++; squares += z * z; within += z * z <= 9 }
  $8 ~ /^failed/ { failed++ }
  END { printf "all: %d values, %.3f within 3, NEES %.2f; %d rigs failed\n", n, n ? within / n : 0, n ? squares / n : 0, failed }' "$table"
