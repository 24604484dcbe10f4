#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Expects scripts/style.sh to take a clean file and to name each kind of fault.
source "$(dirname "${BASH_SOURCE[0]}")/repo_checks.sh"
licence='// SPDX-License-Identifier: BSD-3-Clause'

# tree_with FILE TEXT
tree_with() {
  empty_tree
  put "$1" "$2"
}
tree_with core/imu/a.h "$licence
#pragma once
// TODO(#12): a debt with an issue"
expect_clean style.sh "a clean header"
tree_with core/imu/a.h '#pragma once'
expect_fault style.sh "core/imu/a.h: no SPDX line" "a missing licence line"
tree_with core/imu/a.h "$licence"
expect_fault style.sh "core/imu/a.h: no #pragma once" "a header without a guard"
tree_with core/imu/a.cpp "$licence
$(yes '// line' | head -n 300)"
expect_fault style.sh "core/imu/a.cpp: more than 300 lines" "a file of 301 lines"
tree_with core/imu/a.cpp "$licence
using namespace std;"
expect_fault style.sh "core/imu/a.cpp: using namespace at file scope" "using namespace"
tree_with tests/unit/a.cpp "$licence
// TODO tidy up"
expect_fault style.sh "tests/unit/a.cpp: TODO" "a debt without an issue"
finish
