#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Sets the machine up, builds, and runs every test: the fast ones under asan and ubsan, then all in the release build.
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
export UBSAN_OPTIONS=print_stacktrace=1
# Where a block of thread-local storage of a loaded library happens to lie 16 bytes into a page, the leak checker of g++ 12
# takes the bytes before it for its bounds and crashes; it then does without those blocks.
export ASAN_OPTIONS=intercept_tls_get_addr=0
export LSAN_OPTIONS="suppressions=$PWD/scripts/leaks.supp:print_suppressions=0"

step "packages"
scripts/setup.sh

step "release build"
configure release
build release all

step "minimal build"
configure minimal
build minimal all
ctest --preset minimal --quiet --output-log build/logs/ctest-minimal.log || show_failure ctest-minimal

step "asan and ubsan build of the fast tests"
configure asan
build asan fast_tests

step "fast tests under asan and ubsan"
sanitizers=clean
ctest --preset asan --label-regex '^fast$' --parallel 2 --quiet --output-log build/logs/ctest-asan.log || sanitizers=failed
tail -n 12 build/logs/ctest-asan.log
[[ $sanitizers == clean ]] || cat build/logs/ctest-asan.log

step "all tests of the release build (sanitizers: $sanitizers)"
# Three tests on two cores: those of clusters, servers and pages mostly wait.
ctest --preset release --parallel 3
[[ $sanitizers == clean ]]
