#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Rebuilds the bundles in reports/web/vendor and their licenses from npm. Needed only after a change of a version in
# reports/web/vendor/package.json: the bundles are checked in. three.js is stored as the page contains it: compressed,
# and as text.
#   scripts/bundle_web.sh
set -euo pipefail
vendor="$(cd "$(dirname "${BASH_SOURCE[0]}")/../reports/web/vendor" && pwd)"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

cp "$vendor"/package.json "$vendor"/package-lock.json "$vendor"/*_bundle.js "$work"
npm ci --prefix "$work" --no-audit --no-fund
bundle() { "$work/node_modules/.bin/esbuild" "$work/$1" --bundle --minify --format=iife --global-name="$2" --legal-comments=none --loader:.css=empty; }
bundle flame_bundle.js d3flame >"$vendor/d3-flamegraph.iife.min.js"
bundle three_bundle.js THREE | gzip -9 -n | base64 -w 0 >"$vendor/three.iife.min.js.gz.base64"
cp "$work/node_modules/three/LICENSE" "$vendor/LICENSE.three"
cp "$work/node_modules/d3-flame-graph/LICENSE" "$vendor/LICENSE.d3-flame-graph"
# The modules of D3 share one text, but for d3-ease and internmap.
{
  for module in d3-array internmap d3-ease; do
    [[ "$module" == d3-array ]] && echo "d3-array, d3-color, d3-dispatch, d3-format, d3-hierarchy, d3-interpolate, d3-scale," \
      "d3-selection, d3-time, d3-time-format, d3-timer, d3-transition:" || echo "$module:"
    echo
    cat "$work/node_modules/$module/LICENSE"
    echo
  done
} >"$vendor/LICENSE.d3"
