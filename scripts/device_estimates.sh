#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Error of times that are estimated for a target device by scaling measured ones. Reads the table of
# `stillpoint bench table3_runtime` and the published Table III; prints two tables in Markdown:
# 1. One factor per device, published over measured time of one column of dynamic_vins; tested on its other columns.
# 2. One factor per device and column, from dynamic_vins; tested on the published times of VINS-Mono and VINS-RGBD.
#   scripts/device_estimates.sh build/bench/table3_runtime/table.md
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
[[ -r "${1:-}" ]] || { echo "device_estimates: error: usage: scripts/device_estimates.sh TABLE.md (of bench table3_runtime)" >&2; exit 2; }

awk -v published=reports/published/runtime_market.toml '
function absolute(x) { return x < 0 ? -x : x }
function trim(text) { gsub(/^ +| +$/, "", text); return text }
function read_published(line, estimator, device, count, pairs, i, pair) {
  while ((getline line < published) > 0) {
    if (line ~ /^system = /) {
      split(line, pair, "\""); split(pair[2], pair, " on "); estimator = pair[1]; device = pair[2]
      if (!(device in known)) { known[device] = 1; devices[++device_count] = device }
    }
    if (line !~ /^values = /) continue
    count = split(substr(line, index(line, "{") + 1), pairs, ",")
    for (i = 1; i <= count; ++i) { split(pairs[i], pair, "\""); sub(/^[ =]+/, "", pair[3]); given[device, estimator, pair[2]] = pair[3] + 0 }
  }
}
# Error of an estimate; kept for the median of its table.
function row(device, by, estimator, column, estimate, truth, error) {
  error = estimate / truth - 1
  errors[++error_count] = absolute(error)
  printf "| %s | %s | %s | %s | %.2f | %.2f | %+.0f %% |\n", device, by, estimator, label[column], estimate, truth, 100 * error
}
function summary(i, j, kept) {
  for (i = 2; i <= error_count; ++i) for (j = i; j > 1 && errors[j] < errors[j - 1]; --j) { kept = errors[j]; errors[j] = errors[j - 1]; errors[j - 1] = kept }
  i = int((error_count + 1) / 2)
  printf "\nAbsolute error: median %.0f %%, maximum %.0f %% (%d estimates).\n\n", 50 * (errors[i] + errors[int(error_count / 2) + 1]), 100 * errors[error_count], error_count
  error_count = 0
}
function title(text) {
  printf "%s\n\n| device | calibrated by | estimated for | column | estimate ms | published ms | error |\n|---|---|---|---|---:|---:|---:|\n", text
}
BEGIN {
  FS = "|"
  columns = split("feature_tracking feature_detection tracking_thread dynamic_recognition state_optimization optimization_thread", column, " ")
  split("track,detect,tracking thread,dynamic,state opt,optim thread", names, ",")
  for (i = 1; i <= columns; ++i) { label[column[i]] = names[i]; of_label[names[i] " ms"] = column[i] }
  systems = split("VINS-Mono,VINS-RGBD,Dynamic-VINS", estimator, ",")
  split("baselines/vins_mono+libraries,baselines/vins_rgbd+libraries,dynamic_vins+libraries", variants, ",")
  for (i = 1; i <= systems; ++i) of_variant[variants[i]] = estimator[i]
  read_published()
}
/variant/ && !variant_field { for (i = 1; i <= NF; ++i) { name = trim($i); if (name == "variant") variant_field = i; if (name in of_label) field[of_label[name]] = i } }
variant_field && trim($variant_field) in of_variant {
  for (i = 1; i <= columns; ++i) if ($field[column[i]] + 0 > 0) measured[of_variant[trim($variant_field)], column[i]] = $field[column[i]] + 0
}
END {
  own = estimator[3]
  if (!((own, "tracking_thread") in measured)) { print "device_estimates: error: the table has no times of dynamic_vins+libraries" > "/dev/stderr"; exit 2 }
  for (calibration = 3; calibration <= 6; calibration += 3) {
    by = column[calibration]
    title("### One factor: " label[by] " of dynamic_vins")
    for (d = 1; d <= device_count; ++d) {
      factor = given[devices[d], own, by] / measured[own, by]
      for (i = 1; i <= columns; ++i) if (column[i] != by && (own, column[i]) in measured)
        row(devices[d], sprintf("%s, factor %.2f", label[by], factor), own, column[i], factor * measured[own, column[i]], given[devices[d], own, column[i]])
    }
    summary()
  }
  title("### One factor per column of dynamic_vins")
  for (d = 1; d <= device_count; ++d) for (s = 1; s < systems; ++s) for (i = 1; i <= columns; ++i) {
    if (!((devices[d], estimator[s], column[i]) in given) || !((estimator[s], column[i]) in measured) || !((own, column[i]) in measured)) continue
    factor = given[devices[d], own, column[i]] / measured[own, column[i]]
    row(devices[d], sprintf("same column, factor %.2f", factor), estimator[s], column[i], factor * measured[estimator[s], column[i]], given[devices[d], estimator[s], column[i]])
  }
  summary()
}' "$1"
