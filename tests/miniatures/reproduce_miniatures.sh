#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From nothing to the tables of `reproduce --real`, with miniatures of all sequences and a local mirror of their hosts:
#   tests/miniatures/reproduce_miniatures.sh BUILD OUT [SECONDS [TARGETS]]     e.g. build/dev build/mini 2 "table1 bonn"
# OUT must not exist. The targets mirror_server and device_bag must have been built. The bags of VCU-RVI, which are not on
# a host, are registered as their catalogue says. Takes several minutes; it is not part of the tests.
set -euo pipefail
build="$(realpath "$1")"
out="$(realpath -m "$2")"
seconds="${3:-2}"
targets="${4:-table1 table2 table3 openloris bonn vcu_rvi}"
port="${STILLPOINT_MIRROR_PORT:-8099}"
folder="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
[[ ! -e "$out" ]] || { echo "$out exists; choose another folder" >&2; exit 2; }

# The archives that the targets need
datasets=""
[[ ! " $targets " =~ \ table[12]\  ]] || datasets+=" tum"
[[ ! " $targets " =~ \ (table3|openloris)\  ]] || datasets+=" openloris"
[[ ! " $targets " =~ \ bonn\  ]] || datasets+=" bonn"
[[ ! " $targets " =~ \ vcu_rvi\  ]] || datasets+=" vcu_rvi"
"$folder/make_miniatures.sh" "$build/stillpoint" "$out" "$seconds" "$datasets"

"$build/tests/mirror_server" "$out/host" "$port" &
server=$!
trap 'kill "$server"' EXIT
export STILLPOINT_CATALOGUE="$out/catalogue" STILLPOINT_MIRROR="http://127.0.0.1:$port"
export STILLPOINT_DATA="$out/data" STILLPOINT_REGISTRY="$out/registry.json" STILLPOINT_CACHE="$out/cache"
for bag in "$out"/by_hand/*.bag; do
  [[ ! -f "$bag" ]] || "$build/stillpoint" data add "vcu_rvi_$(basename "$bag" .bag)" "$bag"
done
for target in $targets; do
  "$build/stillpoint" reproduce "$target" --real --get --accept-licence --store "$out/store.sqlite" \
    --out "$out/tables/$target"
done
