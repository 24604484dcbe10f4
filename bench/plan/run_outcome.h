// SPDX-License-Identifier: BSD-3-Clause
/// What is stored of a process that made a run.
#pragma once

#include "bench/systems/slam_system.h"

namespace stillpoint {

/// The system's own account, or how a limit or a signal ended it; what the process took, and the plan's
/// recipes, beside it.
[[nodiscard]] RunOutcome outcome_of_run(const SlamSystem& system, const RunRequest& request,
                                        const ProcessEnd& end, const BenchPlan& plan);

}  // namespace stillpoint
