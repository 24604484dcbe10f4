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
$(yes '// line' | head -n 600)"
expect_fault style.sh "core/imu/a.cpp: more than 600 lines" "a file of 601 lines"
empty_tree
for number in {1..20}; do put "core/imu/a$number.cpp" "$licence"; done
put core/imu/detail/a.cpp "$licence"
expect_clean style.sh "a folder of 20 files, and one below it"
put core/imu/a21.cpp "$licence"
expect_fault style.sh "core/imu: more than 20 files" "a folder of 21 files"
tree_with tests/unit/imu/b_test.cpp "$licence"
put tests/unit/imu/CMakeLists.txt 'stillpoint_test(imu_test fast LIBRARIES stillpoint_imu)'
expect_clean style.sh "a test program of all files of a folder"
put tests/unit/imu/CMakeLists.txt 'stillpoint_test(imu_test fast
  SOURCES a_test.cpp)'
expect_fault style.sh "tests/unit/imu/b_test.cpp: no test program contains it" "a test without a program"
tree_with core/imu/a.cpp "$licence
using namespace std;"
expect_fault style.sh "core/imu/a.cpp: using namespace at file scope" "using namespace"
tree_with tests/unit/a.cpp "$licence
// TODO tidy up"
expect_fault style.sh "tests/unit/a.cpp: TODO" "a debt without an issue"
tree_with core/imu/a.cpp "$licence
int a() {
$(yes '  step();' | head -n 58)
}"
expect_clean style.sh "a function of 60 lines"
tree_with core/imu/a.cpp "$licence
int a() {
$(yes '  step();' | head -n 59)
}"
expect_fault style.sh "core/imu/a.cpp:2 a: more than 60 lines" "a function of 61 lines"
tree_with core/imu/a.cpp "$licence
double a(int b, const std::map<int, int>& c, double (*f)(int, int), int d = g(1, 2)) { return 0.0; }
int callback(void* context, const char* name, long, long, unsigned, void**) { return 0; }"
expect_clean style.sh "four parameters, and a callback with unnamed ones"
tree_with core/imu/a.cpp "$licence
int a(int b, const std::map<int, int>& c, double d, int e, Pose&& f) { return 0; }"
expect_fault style.sh "core/imu/a.cpp:2 a: more than 4 parameters" "five parameters"
finish
