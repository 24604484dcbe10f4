#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Expects scripts/paper_map.sh to take a true map and to refuse rows and links that lead nowhere.
source "$(dirname "${BASH_SOURCE[0]}")/ground.sh"

# house_with_row ROW [TEXT AFTER THE MAP]
house_with_row() {
  empty_house
  put core/imu/buffer.h '#pragma once'
  put README.md "<!-- paper map -->
| paper | files | entry |
|---|---|---|
| II | \`core/imu/buffer\` | \`add\` |
$1
<!-- end of paper map -->
${2:-}"
}
house_with_row '| III | `core/imu`, `core/imu/buffer.h` | |' 'see [the buffer](core/imu/buffer.h) and [the web](https://example.org)'
expect_clean paper_map.sh "a true map"
house_with_row '| III-A | `core/imu/buffer`, `core/imu/gone` | |'
expect_fault paper_map.sh "core/imu/gone" "a row that names a missing file"
house_with_row '| III-B | to come | |'
expect_fault paper_map.sh "1 row(s)" "a row without a path"
house_with_row '| III | `core/imu` | |' 'see [a picture](docs/gone.png)'
expect_fault paper_map.sh "docs/gone.png" "a dead link"
empty_house
put README.md 'no map at all'
expect_fault paper_map.sh "empty" "a README without a map"
finish
