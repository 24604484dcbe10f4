#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes a TUM sequence of three 8x6 frames, 40 ms apart, with ground truth along x at 1 m/s, into FOLDER, and in
# FOLDER/estimate.tum a trajectory that lies 1 m beside the ground truth.
#   make_sequence.sh FOLDER
set -euo pipefail
rm -rf "$1"
mkdir -p "$1"/{rgb,depth}
cd "$1"

pixels() { for ((i = 0; i < $1; ++i)); do printf '%d\n' "$2"; done; }
for stamp in 1.00 1.04 1.08; do
  { printf 'P3\n8 6\n255\n' && pixels 144 128; } >rgb/$stamp.ppm
  { printf 'P2\n8 6\n65535\n' && pixels 48 5000; } >depth/$stamp.pgm
  echo "$stamp rgb/$stamp.ppm" >>rgb.txt
  echo "$stamp depth/$stamp.pgm" >>depth.txt
done
for centiseconds in {90..120}; do
  stamp="$(printf '%d.%02d' $((centiseconds / 100)) $((centiseconds % 100)))"
  x="$(printf '0.%02d' $((centiseconds - 90)))"
  echo "$stamp $x 0 0 0 0 0 1" >>groundtruth.txt
  echo "$stamp $x 1 0 0 0 0 1" >>estimate.tum
done
printf '[camera]\nwidth = 8\nheight = 6\nfx = 10\nfy = 10\ncx = 3.5\ncy = 2.5\n' >rig.toml
