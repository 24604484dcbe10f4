#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the program of STILLPOINT_MINIMAL on a written sequence, evaluates the trajectory, and checks that what it does not
# have is refused, and that it opens none of the libraries of these parts.
#   run.sh PROGRAM
set -euo pipefail
program="$1"
scratch="$(mktemp -d)"
trap 'rm -rf "$scratch"' EXIT
sequence="$scratch/sequence"
export STILLPOINT_CACHE="$scratch/cache"

fail() {
  echo "minimal: $1"
  if [[ -e "$scratch/output" ]]; then cat "$scratch/output"; fi
  exit 1
}

# refused TEXT ARGUMENT...: exit code 2, and an error with TEXT and the name of the option of the build
refused() {
  local text="$1" code=0
  shift
  "$program" "$@" >"$scratch/output" 2>&1 || code=$?
  [[ $code == 2 ]] || fail "exit code $code instead of 2: $*"
  grep -qF "$text" "$scratch/output" || fail "no \"$text\": $*"
  grep -qF STILLPOINT_MINIMAL "$scratch/output" || fail "the error does not name STILLPOINT_MINIMAL: $*"
}

# A textured plane 2 m in front of a camera that moves 1 cm per frame along x: 10 frames of 160x120.
mkdir -p "$sequence"/{rgb,depth}
printf '[camera]\nwidth = 160\nheight = 120\nfx = 100\nfy = 100\ncx = 79.5\ncy = 59.5\n' >"$sequence/rig.toml"
for frame in {0..9}; do
  stamp="1.$(printf '%02d' $((4 * frame)))"
  awk -v shift_px="$((frame / 2))" 'BEGIN {
    print "P2\n160 120\n255"
    for (y = 0; y < 120; ++y) for (x = 0; x < 160; ++x) {
      u = int((x + shift_px) / 8); v = int(y / 8)
      print 40 + (u * 7919 + v * 104729 + u * v * 31) % 180
    }
  }' >"$sequence/rgb/$stamp.pgm"
  awk 'BEGIN { print "P2\n160 120\n65535"; for (i = 0; i < 19200; ++i) print 10000 }' >"$sequence/depth/$stamp.pgm"
  echo "$stamp rgb/$stamp.pgm" >>"$sequence/rgb.txt"
  echo "$stamp depth/$stamp.pgm" >>"$sequence/depth.txt"
  echo "$stamp 0.$(printf '%02d' "$frame") 0 0 0 0 0 1" >>"$sequence/groundtruth.txt"
done

"$program" data check "$sequence" >"$scratch/output" 2>&1 || fail "data check"
"$program" run "$sequence" --variant vo --set detector.kind=none --out "$scratch/run" >"$scratch/output" 2>&1 || fail "run"
grep -q "10 of 10 frames" "$scratch/output" || fail "run does not process the 10 frames"
"$program" eval "$sequence/groundtruth.txt" "$scratch/run/trajectory.tum" --protocol compat:tum \
  --plot "$scratch/plot.svg" >"$scratch/output" 2>&1 || fail "eval"
grep -q compat:tum "$scratch/output" || fail "eval prints no protocol"
[[ -s "$scratch/plot.svg" ]] || fail "eval writes no plot"
"$program" config show >/dev/null || fail "config show"
"$program" device info >/dev/null || fail "device info"

refused "has no renderer" run market
refused "writes no MCAP files" run "$sequence" --variant vo --set detector.kind=none --out "$scratch/mcap_run" --mcap "$scratch/run.mcap"
refused "reads none" run "$(mktemp -p "$scratch" XXXX.bag)"
refused "reads none" eval "$(mktemp -p "$scratch" XXXX.mcap):/odom" "$scratch/run/trajectory.tum"
refused "writes none" eval "$sequence/groundtruth.txt" "$scratch/run/trajectory.tum" --plot "$scratch/plot.pdf"

refused "writes none" eval openloris "$scratch" --ground-truth "$scratch" --figure "$scratch/figure"
[[ ! -e "$scratch/figure.svg" ]] || fail "eval openloris writes one of two figures"

refused "no map tiles" eval "$sequence/groundtruth.txt" "$scratch/run/trajectory.tum" --plot "$scratch/plot.svg" \
  --map-tiles "file:///{z}/{x}/{y}.png" --map-crs EPSG:32632
absent='assimp|embree|curl|microhttpd|archive|cairo|libproj|sqlite|libcrypto|bz2'
ldd "$program" >"$scratch/output" || fail "ldd"
if grep -E "$absent" "$scratch/output"; then fail "the program opens the libraries above"; fi
# Debian's OpenCV opens TBB; the program itself does not.
readelf -d "$program" >"$scratch/output" || fail "readelf"
if grep NEEDED "$scratch/output" | grep -E 'tbb|lz4|zstd'; then fail "the program is linked with the libraries above"; fi
