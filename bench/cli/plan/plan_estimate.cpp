// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/plan/plan_estimate.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "bench/cli/progress.h"
#include "bench/plan/run_cost.h"
#include "bench/store/store.h"

namespace stillpoint::bench {
namespace {

/// How many expected durations have each source.
std::string source_text(const std::vector<RunCost>& costs) {
  const auto count = [&](CostSource source) { return std::ranges::count(costs, source, &RunCost::source); };
  return fmt::format(
      "based on earlier runs of the same variant: {}, of the same sequence: {}, on the time per frame: {}, "
      "assumed: {}\n",
      count(CostSource::kSameRun), count(CostSource::kSequence), count(CostSource::kFrames),
      count(CostSource::kAssumed));
}

}  // namespace

std::string estimate_text(const PlanMatrix& matrix, const std::filesystem::path& store, int jobs) {
  const std::vector<StoredRun> history =
      std::filesystem::exists(store) ? Store(store).runs() : std::vector<StoredRun>{};
  std::set<std::string> stored;
  for (const StoredRun& run : history) stored.insert(run.key);
  PlanMatrix pending = matrix;
  std::erase_if(pending.runs, [&](const PlannedRun& run) {
    return stored.contains(run_key(run.identity)) ||
           !matrix.sequences[run.sequence].unavailable_reason.empty();
  });
  const std::vector<RunCost> costs = expected_costs(pending, history);
  std::vector<double> seconds;
  for (const RunCost& cost : costs) seconds.push_back(cost.seconds);
  std::ranges::sort(seconds, std::greater<>());
  const int workers = matrix.plan.kind == RunKind::kTiming ? 1 : jobs;
  return fmt::format("{} of {} runs to execute, {} of one worker; with {} at once: {}\n", seconds.size(),
                     matrix.runs.size(), duration_text(std::reduce(seconds.begin(), seconds.end())), workers,
                     duration_text(scheduled_seconds(seconds, workers))) +
         source_text(costs);
}

}  // namespace stillpoint::bench
