#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Compares the poses of `stillpoint run` and of the example run_dataset on a rendered sequence: by default, where the
# example has a default-constructed config, and with the name of another config.
#   same_bits.sh PROGRAM EXAMPLE FOLDER
set -euo pipefail
program="$1" example="$2" folder="$3"
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
"$program" data synth walking_xyz --seconds 1 --out seq
# compare NAME [CONFIG]
compare() {
  "$program" run seq ${2:+--config "$2"} --out "$1"
  "$example" seq "$1.tum" ${2:+"$2"}
  (($(grep -vc '^#' "$1.tum") >= 15)) || { echo "$1: too few poses to compare"; exit 1; }
  diff "$1/trajectory.tum" "$1.tum"
}
compare default
compare published dynamic_vins_vo
