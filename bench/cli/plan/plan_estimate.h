// SPDX-License-Identifier: BSD-3-Clause
/// Expected duration of a plan as text.
#pragma once

#include <filesystem>
#include <string>

#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

struct EstimatedWorkers {
  int jobs = 1;       ///< concurrent accuracy runs on this machine
  int tasks = 0;      ///< of an executor; 0 = none
  int simulated = 0;  ///< workers of a simulation; 0 = none
};

/// Expected wall time of the runs that are not in the store, and what the expectation is based on. Rendering
/// of sequences is not included.
/// @param store need not exist
/// @param workers `tasks` > 0 adds the expected wall times with 1, 2, 4, ... up to that many tasks;
/// `simulated` > 0 adds a simulation of the plan and of its multiples with as many tasks as workers, or
/// `tasks`
[[nodiscard]] std::string estimate_text(const PlanMatrix& matrix, const std::filesystem::path& store,
                                        const EstimatedWorkers& workers);

}  // namespace stillpoint::bench
