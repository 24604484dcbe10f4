// SPDX-License-Identifier: BSD-3-Clause
/// Console progress output of plans.
#pragma once

#include "bench/plan/execution/plan_runner.h"

namespace stillpoint::bench {

/// Hooks that log each step and draw progress lines for renderings and runs on stderr. They stop the plan on
/// SIGINT and SIGTERM.
[[nodiscard]] PlanHooks plan_progress();

}  // namespace stillpoint::bench
