// SPDX-License-Identifier: BSD-3-Clause
// What the page uses of d3-flame-graph; see scripts/bundle_web.sh.
export { default as flamegraph } from "d3-flame-graph";
export { select } from "d3-selection";
