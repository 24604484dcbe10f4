#!/bin/bash
# Monte Carlo simulation of the normalized estimation error (NEES): 50 runs of 30 s with drawn noise, biases and their
# random walks, five times from 3 s on, relative to the first pose. Noise is configured as simulated, and that of the IMU
# is not adapted; a reprojection residual is the difference of two bearings of 0.5 px.
# scripts/nees.sh [BUILD_FOLDER] [nees_program arguments], e.g.
# scripts/nees.sh build/release --runs 10 --first-seed 51 --draw time_offset_s=0.04 backend.prior=published
set -e
cd "$(dirname "$0")/.."
build=build/release
if [[ -d "$1" ]]; then build=$1; shift; fi
ninja -C "$build" nees_program >&2
"$build/tests/nees_program" backend.covariance=true imu.noise_scale=1 imu.adapt_noise=false backend.pixel_sigma_px=0.707 \
  backend.cauchy_scale=3 "$@"
