// SPDX-License-Identifier: BSD-3-Clause
/// Validates what a plan refers to, so that errors are reported before its first run.
#pragma once

#include "bench/plan/bench_plan.h"

namespace stillpoint::bench {

/// Loads each config of the plan, and checks its presets, sweeps, protocols, systems, processors and
/// published tables. Recorded sequences are checked when the plan is expanded.
/// @throws InputError with file and line of the plan for an unknown name (with the nearest one), a value out
/// of range, and a seed, variant, system, protocol or sweep value that is listed twice
void validate_plan(const BenchPlan& plan);

/// Requires that the plan names a sequence, and that each group of sequences has a variant or a system.
/// @throws InputError with the missing key
void require_runs(const BenchPlan& plan);

}  // namespace stillpoint::bench
