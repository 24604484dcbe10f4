// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/run_order.h"

#include <algorithm>
#include <functional>
#include <tuple>

#include "bench/plan/execution/run_cost.h"

namespace stillpoint::bench {

std::vector<std::size_t> execution_order(const PlanMatrix& matrix, std::span<const StoredRun> history,
                                         int jobs) {
  std::vector<std::size_t> order;
  for (std::size_t run = 0; run < matrix.runs.size(); ++run) {
    if (matrix.sequences[matrix.runs[run].sequence].unavailable_reason.empty()) order.push_back(run);
  }
  if (matrix.plan.kind == RunKind::kTiming || jobs == 1) return order;
  const std::vector<RunCost> costs = expected_costs(matrix, history);
  std::vector<double> longest_s(matrix.sequences.size(), 0.0);
  for (const std::size_t run : order) {
    double& maximum = longest_s[matrix.runs[run].sequence];
    maximum = std::max(maximum, costs[run].seconds);
  }
  std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t run) {
    const std::size_t sequence = matrix.runs[run].sequence;
    return std::tuple(longest_s[sequence], longest_s.size() - sequence, costs[run].seconds);
  });
  return order;
}

}  // namespace stillpoint::bench
