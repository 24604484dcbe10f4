#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Expects scripts/paper_map.sh to take a true map and to refuse rows and links that lead nowhere.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

# readme_with_row ROW [TEXT AFTER THE MAP]
readme_with_row() {
  empty_tree
  put core/imu/buffer.h '#pragma once'
  put README.md "<!-- paper map -->
| paper | files | entry |
|---|---|---|
| II | \`core/imu/buffer\` | \`add\` |
$1
<!-- end of paper map -->
${2:-}"
}
readme_with_row '| III | `core/imu`, `core/imu/buffer.h` | |' 'see [the buffer](core/imu/buffer.h) and [the web](https://example.org)'
expect_clean paper_map.sh "a true map"
readme_with_row '| III-A | `core/imu/buffer`, `core/imu/gone` | |'
expect_fault paper_map.sh "core/imu/gone" "a row that names a missing file"
readme_with_row '| III-B | to come | |'
expect_fault paper_map.sh "1 row(s)" "a row without a path"
readme_with_row '| III | `core/imu` | |' 'see [an image](docs/gone.png)'
expect_fault paper_map.sh "docs/gone.png" "a dead link"
empty_tree
put README.md 'no map at all'
expect_fault paper_map.sh "empty" "a README without a map"
finish
