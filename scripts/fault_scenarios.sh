#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the simulated fault scenarios with several seeds of the noise, and prints error and duration of each.
#   scripts/fault_scenarios.sh [SEEDS [BUILD_FOLDER]]      10 seeds, build/release by default
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build="${2:-build/release}"
ninja -C "$build" fault_scenarios_test >&2
STILLPOINT_FAULT_SEEDS="${1:-10}" "$build/tests/fault_scenarios_test" --gtest_brief=1
