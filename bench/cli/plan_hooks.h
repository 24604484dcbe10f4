// SPDX-License-Identifier: BSD-3-Clause
/// What a terminal hears while the runs of a plan are made.
#pragma once

#include "bench/plan/plan_runner.h"

namespace stillpoint {

/// Tells what is being done, how far a rendering is, and how long the rest may take.
[[nodiscard]] PlanHooks plan_hooks();

}  // namespace stillpoint
