#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures commits of this repository by `stillpoint history` on three rendered sequences with people, 3 seeds, and makes the
# dashboard. The same command continues. Each commit is built, the first ones, without a minimal preset, in half an hour of a core.
# scripts/own_history.sh FOLDER COMMIT..., e.g. scripts/own_history.sh /tmp/history 0aa94df1 HEAD
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
if (($# < 2)); then
  echo "scripts/own_history.sh: name a folder and commits, e.g. /tmp/history 0aa94df1 HEAD" >&2
  exit 2
fi
folder=$(realpath -m "$1")
shift
stillpoint=$PWD/build/release/stillpoint
mkdir -p "$folder"

for preset in walking_xyz walking_rpy market; do
  [[ -e $folder/$preset ]] || "$stillpoint" data synth $preset --seconds 12 --out "$folder/$preset"
done

# The first commits have no preset of the small program.
cat > "$folder/stillpoint.toml" <<EOF
name = "stillpoint"
version = "1"
command = ["{binary}", "run", "{sequence}", "--config", "stillpoint", "--set", "seed={seed}", "--out", "{out}/run"]
layout = "as_is"
trajectory = "run/trajectory.tum"
poses = "camera"
[source]
git = "$PWD"
build = ["sh", "-c", "export CCACHE_BASEDIR=\$PWD; p=release; grep -q '\"minimal\"' CMakePresets.json && p=minimal; cmake --preset \$p -B build/own && cmake --build build/own --target stillpoint"]
binary = "build/own/stillpoint"
EOF
cat > "$folder/plan.toml" <<EOF
title = "The default over commits"
systems = ["$folder/stillpoint.toml"]
seeds = [1, 2, 3]

[recorded]
sequences = ["$folder/walking_xyz", "$folder/walking_rpy", "$folder/market"]
EOF

for commit in "$@"; do
  "$stillpoint" history "$commit^..$commit" --system "$folder/stillpoint.toml" --plan "$folder/plan.toml" \
    --store "$folder/history.sqlite" --builds "$folder/builds"
done
"$stillpoint" dashboard "$folder/history.sqlite" --system stillpoint --repository "$PWD" --out "$folder/dashboard"
