// SPDX-License-Identifier: BSD-3-Clause
/// Derives the stored outcome of a run from its finished process.
#pragma once

#include "bench/plan/bench_plan.h"
#include "bench/systems/slam_system.h"

namespace stillpoint::bench {

/// The outcome reported by the system, or the limit or signal that terminated it, together with the resource
/// usage of the process and the metrics of the plan's evaluation protocols.
[[nodiscard]] RunOutcome outcome_of_run(const SlamSystem& system, const RunRequest& request,
                                        const ProcessResult& end, const BenchPlan& plan);

}  // namespace stillpoint::bench
