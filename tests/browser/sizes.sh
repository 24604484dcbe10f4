#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints sizes and times of the pages of large stores: reports of 15, 100 and 500 runs of a minute, in one file and served,
# and the dashboard of 10,200 runs over 300 commits. Takes 10 minutes and 2 GB; not part of CTest.
#   tests/browser/sizes.sh STILLPOINT WORK
# WORK/store.sqlite of an earlier pages.sh has the runs that the large stores are made of.
source "$(dirname "${BASH_SOURCE[0]}")/browser.sh"
[[ -e "$work/store.sqlite" ]] || skip "no $work/store.sqlite; tests/browser/pages.sh STILLPOINT WORK"

visit() { BROWSER="$browser" node "$here/sizes.mjs" open "$1"; }

"$program" store export "$work/export.json" --store "$work/store.sqlite" --force
for count in 15 100 500; do
  store="$work/$count.sqlite"
  rm -rf "$store" "$store.files"
  for ((first = 0; first < count; first += 25)); do # a whole export would need gigabytes of memory
    node "$here/sizes.mjs" runs "$work/export.json" "$first" $((first + 25 < count ? first + 25 : count)) "$work/part.json"
    "$program" store import "$work/part.json" --store "$store" 2>/dev/null
  done
  "$program" report "$store" --out "$work/report_$count"
  visit "file://$work/report_$count/index.html"
  "$program" serve "$store" --port 0 2>"$work/serve.log" &
  server=$!
  until url="$(grep -oE 'http://127[0-9.:]+/' "$work/serve.log")"; do kill -0 "$server"; sleep 0.2; done
  echo "served: $(curl -s "${url}report/" | wc -c) bytes without the data of runs, $(grep VmRSS "/proc/$server/status")"
  visit "${url}report/"
  kill "$server"
  wait "$server" || true
done
rm -rf "$work/history.sqlite" "$work/history.sqlite.files"
node "$here/sizes.mjs" history "$work/history.json"
"$program" store import "$work/history.json" --store "$work/history.sqlite"
time "$program" dashboard "$work/history.sqlite" --out "$work/dashboard"
wc -c "$work/dashboard/index.html"
visit "file://$work/dashboard/index.html"
