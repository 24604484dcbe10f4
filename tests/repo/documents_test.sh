#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Expects scripts/documents.sh to take true documents and to refuse rows, links and paths that lead nowhere, documents that
# are too long, and diagrams that are not up to date.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"

# map_with_row ROW: a tree whose paper map has that row
map_with_row() {
  empty_tree
  put core/imu/buffer.h '#pragma once'
  put core/README.md "<!-- paper map -->
| paper | files | entry |
|---|---|---|
| II | \`core/imu/buffer\` | \`add\` |
$1
<!-- end of paper map -->"
}
row='| III | `core/imu`, `core/imu/buffer.h` | |'
# with_document PATH TEXT: a tree with a true map and that document
with_document() {
  map_with_row "$row"
  put "$1" "$2"
}
map_with_row "$row"
expect_clean documents.sh "a true map"
map_with_row '| III-A | `core/imu/buffer`, `core/imu/gone` | |'
expect_fault documents.sh "core/imu/gone" "a row that names a missing file"
map_with_row '| III-B | to come | |'
expect_fault documents.sh "1 row(s)" "a row without a path"
empty_tree
put core/README.md 'no map at all'
expect_fault documents.sh "empty" "a document without a map"

with_document README.md 'see [the buffer](core/imu/buffer.h), `core/imu/buffer` and [the web](https://example.org)'
expect_clean documents.sh "links and paths that exist"
with_document README.md 'see [an image](docs/gone.png)'
expect_fault documents.sh "README.md: links to docs/gone.png" "a dead link"
with_document eval/README.md 'see [the buffer](core/imu/buffer.h)'
expect_fault documents.sh "eval/README.md: links to core/imu/buffer.h" "a link that is not relative to its document"
with_document bench/README.md 'see `core/imu/gone.h`'
expect_fault documents.sh "names core/imu/gone.h" "a path in code marks that does not exist"
with_document reports/measured/long.md "$(printf 'line\n%.0s' {1..121})"
expect_fault documents.sh "more than 120 lines" "a page that is too long"

with_document core/imu/queue.h '/// See buffer.h and core/imu/buffer.h.
#include "lib/vector.h"
int x;  // as in vector.h'
expect_clean documents.sh "headers that exist"
put core/imu/queue.h '/// See (gone.h).'
expect_fault documents.sh "core/imu/queue.h: a comment names gone.h" "a header that does not exist"

with_document README.md 'set `backend.solver` and `imu.walk`, see imu.txt'
put program 'echo "| \`backend.solver\` |"'
chmod +x "$scratch/program"
output="$("$root/scripts/documents.sh" "$scratch" "$scratch/program" 2>&1)" && fail "a key that does not exist is not seen"
[[ "$output" == *"imu.walk"* && "$output" != *"backend.solver"* && "$output" != *"imu.txt"* ]] || fail "keys: $output"

with_document core/diagrams/a.dot 'digraph { a; }'
put core/diagrams/a.svg "<!-- source: $(sha256sum "$scratch/core/diagrams/a.dot" | cut -c1-64) -->"
expect_clean documents.sh "a diagram of its source"
put core/diagrams/a.dot 'digraph { b; }'
expect_fault documents.sh "a.dot: its SVG" "a diagram of another source"
finish
