#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes small rendered sequences under the names, folders and archive formats of the real datasets, and a catalogue
# with their digests, so that `reproduce --real --get` can be executed without the real hosts:
#   tests/miniatures/make_miniatures.sh PROGRAM OUT [SECONDS [DATASETS]]      e.g. build/dev/stillpoint build/mini 2 "tum bonn"
#   build/dev/tests/mirror_server OUT/host 8099 &
#   STILLPOINT_CATALOGUE=OUT/catalogue STILLPOINT_MIRROR=http://127.0.0.1:8099 STILLPOINT_DATA=OUT/data \
#     STILLPOINT_REGISTRY=OUT/registry.json build/dev/stillpoint reproduce table1 --real --get --accept-licence
# The images differ from the recordings: the tables test the chain of commands, not the odometry.
set -euo pipefail
program="$(realpath "$1")"
out="$(realpath -m "$2")"
seconds="${3:-2}"
datasets="${4:-tum bonn openloris}"
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
mkdir -p "$out/host" "$out/catalogue" "$out/work"
seed=0

# render PRESET LAYOUT FOLDER: a sequence of its own seed
render() {
  seed=$((seed + 1))
  "$program" data synth "$1" --layout "$2" --seconds "$seconds" --seed "$seed" --width 320 --height 240 --focal 267.5 \
    --out "$out/work/$3" >/dev/null
  echo "miniatures: $3"
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
      local name="rgbd_dataset_freiburg3_${people}_$motion" preset="walking_$motion"
      [[ $people == walking ]] || preset+=_empty
      render "$preset" tum "$name"
      tar -C "$out/work" -czf "$out/host/tum/freiburg3/$name.tgz" "$name"
    done
  done
  # Only these are offered.
  catalogue tum
}

make_bonn() {
  mkdir -p "$out/host/bonn"
  for name in crowd crowd2 crowd3 person_tracking person_tracking2 synchronous synchronous2; do
    render walking_halfsphere tum "rgbd_bonn_$name"
    (cd "$out/work" && cmake -E tar cf "$out/host/bonn/rgbd_bonn_$name.zip" --format=zip "rgbd_bonn_$name")
  done
  catalogue bonn
}

# nested ARCHIVE SEQUENCES...: a tar with one 7z per sequence
nested() {
  local archive="$1" sequence
  shift
  for sequence in "$@"; do
    local preset=corridor
    [[ $sequence != market* ]] || preset=market
    render "$preset" openloris "$sequence"
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

for dataset in $datasets; do "make_$dataset"; done
rm -rf "$out/work"
