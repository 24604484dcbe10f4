#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Plants single faults in sequences of the OpenLORIS layout (`stillpoint data synth`), and writes how `diagnose` ranks
# them: CSV with the columns sequence, fault, expected, rank (0: not found), effect, found, seconds, least_effect (the
# smallest change of the error that could count; empty if the diagnosis failed). Faults that
# `--fault` has are injected; others are changes of copies of the files. Two faults at once, NAME+NAME in PAIRS (their
# list, with blanks; instead of the single ones), have the rank of the later one.
#   scripts/diagnose_faults.sh PROGRAM TABLE.csv SEQUENCE...        BUDGET (30s) and FAULTS (regular expression, all)
set -euo pipefail
program="$1" table="$2"
shift 2
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

# fault | ids of the cause | arguments of --fault, or file: the change of `changed_copy`
faults='
none | none |
gyro_deg | gyro_unit | file
accel_g | accel_unit | file
gyro_xy | gyro_axes | file
gyro_inverted | gyro_axes | file
imu_turned | imu_axes | file
accel_inverted | accel_axes | file
accel_xz | accel_axes | file
depth_5 | depth_unit | file
depth_fifth | depth_unit | file
standing_start | standing_start | file
truth_late | truth_late | file
truth_noise | truth_noise | file
truth_jump | truth_jump | file
focal_error | focal | focal_error:amount=3
center_error | center | center_error:amount=10
distortion_error | distortion | distortion_error:amount=0.08
rotation_error | extrinsics_rotation | rotation_error:amount=6
depth_scaled | depth_scale | depth_scaled:amount=0.85,start=0,duration=1000
time_offset | time_offset | time_offset:amount=0.03,start=0,duration=1000
clock_drift | clock_drift | clock_drift:amount=5000,start=0,duration=1000
imu_noise | imu_noise | imu_noise:amount=20
imu_vibration | imu_noise | imu_vibration:amount=3
imu_gap | imu_gap | imu_gap:start=3,duration=1
imu_rate | imu_rate | imu_rate:amount=30,start=0,duration=1000
gyro_saturated | gyro_saturated | gyro_saturated:amount=0.1,start=0,duration=1000
accel_saturated | accel_saturated | accel_saturated:amount=9.9,start=0,duration=1000
imu_jitter | imu_jitter | imu_jitter:amount=0.003,start=0,duration=1000
blank | blank | blank:start=3,duration=1.5
frozen | frozen | frozen:start=3,duration=1.5
dropped | dropped | dropped:start=3,duration=1.5
exposure | exposure | exposure:amount=0.05,start=3,duration=2
motion_blur | blur | motion_blur:amount=31,start=3,duration=2
exposure_steps | exposure_steps | exposure_steps:amount=2
depth_late | depth_late | depth_previous:start=0,duration=1000
depth_shift | depth_unregistered | depth_shift:amount=8,start=0,duration=1000
depth_missing | depth_missing | depth_missing:start=3,duration=2
depth_holes | depth_holes | depth_holes:amount=0.8,start=3,duration=3
detector_silent | boxes_missing | detector_silent:start=0,duration=1000
detector_hallucinating | boxes | detector_hallucinating:amount=6,start=0,duration=1000
'

if [[ -n "${PAIRS:-}" ]]; then
  pairs=''
  for pair in $PAIRS; do
    row="$(awk -F' [|] ?' -v first="${pair%%+*}" -v second="${pair##*+}" '
      $1 == first { id1 = $2; how1 = $3 } $1 == second { id2 = $2; how2 = $3 }
      END { printf "%s+%s | %s+%s | %s;%s", first, second, id1, id2, how1, how2 }' <<<"$faults")"
    pairs+="$row"$'\n'
  done
  faults="$pairs"
fi

changed_copy() { # SEQUENCE FAULT FOLDER: the files of the sequence by links, and those with the fault
  local sequence="$1" fault="$2" folder="$3" file
  mkdir -p "$folder"
  for file in "$sequence"/*; do ln -s "$(realpath "$file")" "$folder/"; done
  rewrite() { # FILE awk-program for its rows
    rm "$folder/$1"
    awk "/^#/ { print; next } { $2 }" "$sequence/$1" >"$folder/$1"
  }
  local gyro=d400_gyroscope.txt accel=d400_accelerometer.txt truth=groundtruth.txt
  case "$fault" in
    gyro_deg) rewrite $gyro 'printf "%s %.9f %.9f %.9f\n", $1, $2 * 57.29578, $3 * 57.29578, $4 * 57.29578' ;;
    accel_g) rewrite $accel 'printf "%s %.9f %.9f %.9f\n", $1, $2 / 9.80665, $3 / 9.80665, $4 / 9.80665' ;;
    gyro_xy) rewrite $gyro 'print $1, $3, $2, $4' ;;
    gyro_inverted) rewrite $gyro 'print $1, -$2, -$3, -$4' ;;
    imu_turned)
      rewrite $gyro 'print $1, $2, -$4, $3'
      rewrite $accel 'print $1, $2, -$4, $3'
      ;;
    accel_inverted) rewrite $accel 'print $1, -$2, -$3, -$4' ;;
    accel_xz) rewrite $accel 'print $1, $4, $3, $2' ;;
    depth_5) printf '[depth]\nscale = 5000\n' >"$folder/rig.toml" ;;
    depth_fifth) printf '[depth]\nscale = 200\n' >"$folder/rig.toml" ;;
    standing_start)  # bias of a gyroscope that is found in motion
      rewrite $gyro 'printf "%s %.9f %.9f %.9f\n", $1, $2 + 0.1, $3 - 0.1, $4 + 0.1'
      ;;
    truth_late)
      rewrite $truth 'split($1, part, "."); ns = substr(part[2] "000000000", 1, 9) + 60000000; s = part[1]
        if (ns >= 1000000000) { ns -= 1000000000; ++s }
        printf "%d.%09d", s, ns; for (i = 2; i <= 8; ++i) printf " %s", $i; print ""'
      ;;
    truth_noise) rewrite $truth '$2 += 0.03 * (rand() - 0.5); $3 += 0.03 * (rand() - 0.5); $4 += 0.03 * (rand() - 0.5); print' ;;
    truth_jump) rewrite $truth 'if (++n > 900) $2 += 0.15; print' ;;
  esac
}

[[ -e "$table" ]] || echo "sequence,fault,expected,rank,effect_percent,found,seconds,least_effect_percent" >"$table"
for sequence in "$@"; do
  while IFS='|' read -r fault expected how; do
    fault="${fault// /}" expected="${expected// /}" how="${how// /}"
    [[ -n "$fault" && "$fault" =~ ${FAULTS:-.} ]] || continue
    folder="$sequence" options=()
    read -ra names <<<"${fault//+/ }"
    IFS=';' read -ra changes <<<"$how"
    for i in "${!changes[@]}"; do # the second change of files is made in the copy of the first
      if [[ "${changes[i]}" == file ]]; then
        changed_copy "$folder" "${names[i]}" "$work/$i"
        folder="$work/$i"
      else
        options+=(--fault "${changes[i]}")
      fi
    done
    begin=$SECONDS
    "$program" diagnose "$folder" --json --budget "${BUDGET:-30s}" --length 10 "${options[@]}" >"$work/out.json" 2>"$work/err" && status=0 || status=$?
    if ((status > 1)); then  # an error is not "nothing found"
      echo "$(basename "$sequence"),$fault,$expected,failed,,$(tail -n 1 "$work/err" | tr ',' ';'),$((SECONDS - begin))," >>"$table"
      rm -rf "${work:?}"/[01]
      continue
    fi
    # Causes with an effect first, then the others.
    awk -v sequence="$(basename "$sequence")" -v fault="$fault" -v expected="$expected" -v seconds=$((SECONDS - begin)) '
      /"id":/ { gsub(/[",]/, "", $2); ids[++n] = $2 }
      /"error_ratio":/ { gsub(/,/, "", $2); ratio[n] = $2 }
      /"others":/ { effective = n }
      /"least_effect":/ { gsub(/,/, "", $2); least = $2 }
      END {
        wanted = split(expected, causes, "+")
        for (i = 1; i <= n; ++i) {
          found = found (i > 1 ? " " : "") ids[i] (i <= effective ? "*" : "")
          for (k = 1; k <= wanted; ++k)
            if (ids[i] == causes[k]) { named++; rank = i; effect = ratio[i]; causes[k] = "" }
        }
        if (named < wanted) rank = 0
        printf "%s,%s,%s,%d,%s,%s,%d,%.0f\n", sequence, fault, expected, rank,
          effect == "" || effect == "null" ? "" : sprintf("%+.0f", 100 * (effect - 1)), found, seconds, 100 * least
      }' "$work/out.json" | tee -a "$table"
    rm -rf "${work:?}"/[01]
  done <<<"$faults"
done
