#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Opens the dashboard of a known history in a real headless browser. Exit 77 with a reason where that is not to be had.
#   tests/browser/dashboard.sh STILLPOINT [WORK]
# STILLPOINT_SCREENSHOTS=DIR keeps pictures of the pages.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

store="$work/history.sqlite"
rm -rf "$store" "$store.files"
node "$here/history_store.mjs" >"$work/history.json"
"$program" store import "$work/history.json" --store "$store"
# A plan that asks for the newest run of `vo`, as `bench` would enter it.
mapfile -t keys < <("$program" store list --store "$store" | grep " vo " | cut -d " " -f 1 | tail -n 1)
node "$here/history_store.mjs" "${keys[@]}" >"$work/plan.json"
"$program" store import "$work/plan.json" --store "$store"
"$program" dashboard "$store" --out "$work/dashboard"
BROWSER="$browser" PAGE="$work/dashboard/index.html" node "$here/dashboard.mjs"
