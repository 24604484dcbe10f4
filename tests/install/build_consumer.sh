#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Configures the project SOURCE in the empty folder BUILD, builds it and runs its tests.
#   build_consumer.sh SOURCE BUILD CMAKE_OPTION...
set -euo pipefail
source="$1" build="$2"
shift 2

launcher=()
if command -v ccache >/dev/null; then launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
rm -rf "$build"
"${CMAKE_COMMAND:-cmake}" -S "$source" -B "$build" "${launcher[@]}" "$@"
"${CMAKE_COMMAND:-cmake}" --build "$build" --parallel 2
cd "$build"
"${CMAKE_CTEST_COMMAND:-ctest}" --output-on-failure
