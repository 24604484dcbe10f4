#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs random combinations of faults on short simulated runs, with the address and undefined behavior sanitizers.
#   scripts/fault_combinations.sh [RUNS [FIRST_SEED]]      10000 runs from seed 1 by default
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
runs="${1:-10000}"
first="${2:-1}"
cmake --preset asan > /dev/null
cmake --build build/asan --target fault_combinations_test
jobs="$(nproc)"
share=$(((runs + jobs - 1) / jobs))
pids=()
for ((job = 0; job < jobs; ++job)); do
  STILLPOINT_FAULT_RUNS="$share" STILLPOINT_FAULT_SEED=$((first + job * share)) \
    build/asan/tests/fault_combinations_test --gtest_brief=1 &
  pids+=($!)
done
status=0
for pid in "${pids[@]}"; do wait "$pid" || status=1; done
exit "$status"
