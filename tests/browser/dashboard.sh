#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tests the dashboard of a synthetic history in a headless browser. Exits with 77 if none is available.
#   tests/browser/dashboard.sh STILLPOINT [WORK]
# STILLPOINT_SCREENSHOTS=DIR saves screenshots of the pages.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

store="$work/history.sqlite"
rm -rf "$store" "$store.files"
node "$here/history_store.mjs" >"$work/history.json"
"$program" store import "$work/history.json" --store "$store"
# A plan that contains the newest run of `vo`, as recorded by `bench`.
mapfile -t keys < <("$program" store list --store "$store" | grep " vo " | cut -d " " -f 1 | tail -n 1)
node "$here/history_store.mjs" "${keys[@]}" >"$work/plan.json"
"$program" store import "$work/plan.json" --store "$store"
"$program" dashboard "$store" --out "$work/dashboard"
BROWSER="$browser" PAGE="$work/dashboard/index.html" node "$here/dashboard.mjs"
