#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes small rendered sequences under the names, folders and archive formats of the real datasets, and a catalogue
# with their digests, so that `reproduce --real --get` can be executed without the real hosts:
#   tests/miniatures/make_miniatures.sh PROGRAM OUT [SECONDS [DATASETS]]      e.g. build/dev/stillpoint build/mini 2 "tum bonn"
#   build/dev/tests/mirror_server OUT/host 8099 &
#   STILLPOINT_CATALOGUE=OUT/catalogue STILLPOINT_MIRROR=http://127.0.0.1:8099 STILLPOINT_DATA=OUT/data \
#     STILLPOINT_REGISTRY=OUT/registry.json build/dev/stillpoint reproduce table1 --real --get --accept-licence
# reproduce_miniatures.sh does all of this. STILLPOINT_MINIATURE_WIDTH (default: 160) is the width of the images in
# pixels; the published configs with an IMU initialize from 320 on, the monocular one from 640. STILLPOINT_RECORDINGS
# names a folder of recorded motion (default: shared/data beside the checkout); what it contains replaces rendered
# motion: frame times of fr3 (tum_fr3_times), ground truth of OpenLORIS (openloris/groundtruth), inertial data and
# ground truth of TUM VI, for VCU-RVI (imu/tum_vi).
# The images differ from the recordings: the tables test the chain of commands, not the odometry.
set -euo pipefail
program="$(realpath "$1")"
out="$(realpath -m "$2")"
seconds="${3:-2}"
width="${STILLPOINT_MINIATURE_WIDTH:-160}"
datasets="${4:-tum bonn openloris vcu_rvi}"
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
recordings="${STILLPOINT_RECORDINGS:-$root/../shared/data}"
mkdir -p "$out/host" "$out/catalogue" "$out/work"
seed=0

# render PRESET LAYOUT FOLDER [OPTIONS...]: a sequence of its own seed
render() {
  local preset="$1" layout="$2" folder="$3" source=rendered
  shift 3
  case "$*" in
    *--times*) source="recorded times" ;;
    *--trajectory*) source="recorded motion" ;;
  esac
  seed=$((seed + 1))
  "$program" data synth "$preset" --layout "$layout" --seconds "$seconds" --seed "$seed" --width "$width" \
    --height "$((width * 3 / 4))" --out "$out/work/$folder" "$@" >/dev/null
  echo "miniatures: $folder ($source)"
}

# embed NAME: the catalogue file of the project with the digests of the archives in OUT/host/NAME
catalogue() {
  sed '/^\[archives\./,$d' "$root/datasets/catalogue/$1.toml" >"$out/catalogue/$1.toml"
  (cd "$out/host/$1" && find . -type f | sed 's|^\./||' | sort) | while read -r file; do
    printf '[archives."%s"]\nbytes = %s\nsha256 = "%s"\n' "$file" "$(stat -c %s "$out/host/$1/$file")" \
      "$(sha256sum "$out/host/$1/$file" | cut -d' ' -f1)" >>"$out/catalogue/$1.toml"
  done
}

make_tum() {
  mkdir -p "$out/host/tum/freiburg3"
  for motion in xyz static rpy halfsphere; do
    for people in walking sitting; do
      local name="rgbd_dataset_freiburg3_${people}_$motion" preset="walking_$motion" options=()
      local times="$recordings/tum_fr3_times/fr3_${people}_$motion.txt"
      [[ $people == walking ]] || preset+=_empty
      [[ ! -f $times ]] || options=(--times "$times")
      render "$preset" tum "$name" --depth-units 5000 "${options[@]}"
      tar -C "$out/work" -czf "$out/host/tum/freiburg3/$name.tgz" "$name"
    done
  done
  # Only these are offered.
  catalogue tum
}

# The names of the sequences in the catalogue of the project.
bonn_names() {
  sed -n '/^members = \[/,/\]/p' "$root/datasets/catalogue/bonn.toml" | grep -o '"[a-z0-9_]*"' | tr -d '"'
}

make_bonn() {
  mkdir -p "$out/host/bonn"
  for name in $(bonn_names); do
    local preset=walking_halfsphere
    case "$name" in
      static*) preset=walking_static_empty ;;
      *box*) preset=walking_xyz ;;
    esac
    render "$preset" tum "rgbd_bonn_$name" --depth-units 5000
    # The lists of the real archives name images that they do not contain.
    echo "1700009999.000000 depth/1700009999.000000.png" >>"$out/work/rgbd_bonn_$name/depth.txt"
    (cd "$out/work" && cmake -E tar cf "$out/host/bonn/rgbd_bonn_$name.zip" --format=zip "rgbd_bonn_$name")
  done
  catalogue bonn
}

# openloris_sequence NAME: along the recorded ground truth of NAME, five seconds after its start, or rendered motion
openloris_sequence() {
  local scene="${1%1-*}" number="${1##*-}" preset=corridor
  local truth="$recordings/openloris/groundtruth/gt_${scene}_1.txt"
  [[ $scene != market ]] || preset=market
  if [[ -f $truth ]]; then
    render track openloris "$1" --trajectory "$truth" --track-sequence "$number" --start 5
  else
    render "$preset" openloris "$1"
  fi
}

# nested ARCHIVE SEQUENCES...: a tar with one 7z per sequence
nested() {
  local archive="$1" sequence
  shift
  for sequence in "$@"; do
    openloris_sequence "$sequence"
    (cd "$out/work" && cmake -E tar cf "$sequence.7z" --format=7zip "$sequence")
  done
  if [[ "$archive" == *.7z ]]; then
    cp "$out/work/$1.7z" "$out/host/openloris/package/$archive"
  else
    (cd "$out/work" && tar -cf "$out/host/openloris/package/$archive" "${@/%/.7z}")
  fi
}

make_openloris() {
  mkdir -p "$out/host/openloris/package"
  nested office1-1_7-package.tar office1-{1..7}
  nested home1-1_5-package.tar home1-{1..5}
  nested cafe1-1_2-package.tar cafe1-{1..2}
  nested corridor1-1.7z corridor1-1
  nested corridor1-2_5-package.tar corridor1-{2..5}
  nested market1-1_3-package.tar market1-{1..3}
  catalogue openloris
}

# Bags as a user downloads them with a browser: OUT/by_hand.
make_vcu_rvi() {
  local number name options
  mkdir -p "$out/by_hand"
  for number in 1 2 3 4 5; do
    name="lab-dynamic-0$number"
    options=(walking_xyz openloris "$name")
    # Preset flight: hand-held.
    if [[ -f "$recordings/imu/tum_vi/room1_imu.csv" ]]; then
      options=("flight" openloris "$name" --trajectory "$recordings/imu/tum_vi/room1_groundtruth.txt"
        --imu "$recordings/imu/tum_vi/room1_imu.csv" --start "$((10 * number))")
    fi
    render "${options[@]}"
    "$(dirname "$program")/tests/device_bag" vcu_rvi "$out/work/$name" "$out/by_hand/$name.bag"
  done
}

for dataset in $datasets; do "make_$dataset"; done
rm -rf "$out/work"
