// SPDX-License-Identifier: BSD-3-Clause
/// Order in which the runs of a plan are started.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// Indices of the runs whose sequences are available. Long runs are first, so that the last run does not wait
/// alone; the runs of a sequence remain together, as they share its cached files, and sequences are sorted
/// by their longest run. Timing runs, and runs that are executed one at a time, keep the order of the plan,
/// which alternates the variants.
/// @param history stored runs from which the durations are expected
/// @param jobs number of concurrent runs
[[nodiscard]] std::vector<std::size_t> execution_order(const PlanMatrix& matrix,
                                                       std::span<const StoredRun> history, int jobs);

}  // namespace stillpoint::bench
