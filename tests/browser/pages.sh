#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Tests `serve --watch` during a bench, and the report page of its runs, in a headless browser. Exits with 77 if none is
# available.
#   tests/browser/pages.sh STILLPOINT [WORK]
# STILLPOINT_SCREENSHOTS=DIR saves screenshots of the page, STILLPOINT_REPORT_STORE=FILE uses an existing store.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"

# watch STORE: serves a store that a bench creates, and tests the page until all runs of the plan have ended.
watch() {
  local url="" deadline=$((SECONDS + 30))
  until [[ -e "$1" ]] && "$program" store list --store "$1" >/dev/null 2>&1; do
    ((SECONDS < deadline)) && kill -0 "$bench" || { echo "the bench created no store"; return 1; }
    sleep 0.05
  done
  "$program" serve "$1" --watch --port 0 2>"$work/serve.log" &
  server=$!
  until [[ -n "$url" ]]; do
    ((SECONDS < deadline)) && kill -0 "$server" || { cat "$work/serve.log"; return 1; }
    sleep 0.05
    url="$(grep -oE 'http://127[0-9.:]+/' "$work/serve.log" || true)"
  done
  BROWSER="$browser" URL="$url" SERVER="$server" node "$here/live.mjs" || { kill "$server"; return 1; }
  wait "$server"
}

store="${STILLPOINT_REPORT_STORE:-$work/store.sqlite}"
if [[ -z "${STILLPOINT_REPORT_STORE:-}" ]]; then
  rm -rf "$store" "$store.files" "$work/plan"
  # One run at a time: the store keeps whole seconds, so that of two concurrent ones that end in the same second, the later
  # one may be listed as the earlier one.
  "$program" bench "$here/plan.toml" --jobs 1 --store "$store" --out "$work/plan" >"$work/plan.log" 2>&1 &
  bench=$!
  watch "$store" || { kill "$bench"; wait "$bench" || true; exit 1; }
  wait "$bench"
  for plan in sweep loops; do
    "$program" bench "$here/$plan.toml" --store "$store" --out "$work/$plan" >"$work/$plan.log" 2>&1
  done
fi
"$program" report "$store" --out "$work/page"
BROWSER="$browser" PAGE="$work/page/index.html" WORK="$work" node "$here/report_page.mjs"
