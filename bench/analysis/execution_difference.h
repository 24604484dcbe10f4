// SPDX-License-Identifier: BSD-3-Clause
/// Differences between two executions of the same run, e.g. on two machines or architectures.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/analysis/run_statistics.h"
#include "bench/store/store.h"

namespace stillpoint::bench {

struct ExecutionDifference {
  std::string label;                    ///< sequence, variant, seed
  std::size_t frames = 0;               ///< that both executed
  std::vector<StageDifference> stages;  ///< in the order of execution; empty if not recorded
  bool equal_trajectories = false;      ///< as stored, with nine decimals
  double largest_m = 0.0;               ///< distance between poses of the same time, at most
  double largest_rad = 0.0;             ///< same, angle
  std::optional<double> ate_m;          ///< of either execution
  std::optional<double> other_ate_m;
};

/// One row for each successful run that both stores contain: the same sequence, config, seed and source code.
/// The poses of both are compared as they are, without alignment: both start at the same pose.
/// @param runs of `store`
[[nodiscard]] std::vector<ExecutionDifference> execution_differences(const Store& store,
                                                                     std::span<const StoredRun> runs,
                                                                     const Store& other);

}  // namespace stillpoint::bench
