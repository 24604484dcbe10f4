#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Compares the poses of `stillpoint run` and of the example run_dataset on a rendered sequence, with two configs.
#   same_bits.sh PROGRAM EXAMPLE FOLDER
set -euo pipefail
program="$1" example="$2" folder="$3"
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
"$program" data synth walking_xyz --seconds 1 --out seq
for config in stillpoint dynamic_vins_vo; do
  "$program" run seq --config $config --out $config
  "$example" seq $config.tum $config
  (($(grep -vc '^#' $config.tum) >= 15)) || { echo "$config: too few poses to compare"; exit 1; }
  diff $config/trajectory.tum $config.tum
done
