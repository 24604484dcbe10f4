#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tests the report page in a headless browser. Exits with 77 if none is available.
#   tests/browser/pages.sh STILLPOINT [WORK]
# STILLPOINT_SCREENSHOTS=DIR saves screenshots of the page, STILLPOINT_REPORT_STORE=FILE uses an existing store.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

store="${STILLPOINT_REPORT_STORE:-$work/store.sqlite}"
if [[ -z "${STILLPOINT_REPORT_STORE:-}" ]]; then
  for plan in plan sweep; do
    "$program" bench "$here/$plan.toml" --store "$store" --out "$work/$plan" >"$work/$plan.log" 2>&1
  done
fi
"$program" report "$store" --out "$work/page"
BROWSER="$browser" PAGE="$work/page/index.html" WORK="$work" node "$here/report_page.mjs"
