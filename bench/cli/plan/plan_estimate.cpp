// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/plan/plan_estimate.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "bench/cli/progress.h"
#include "bench/plan/execution/run_cost.h"
#include "bench/store/store.h"

namespace stillpoint::bench {
namespace {

/// Time that `store merge` needs for one run with annotated images, see reports/measured/scaling.md.
constexpr double kMergeSecondsPerRun = 0.17;

/// How many expected durations have each source.
std::string source_text(const std::vector<RunCost>& costs) {
  const auto count = [&](CostSource source) { return std::ranges::count(costs, source, &RunCost::source); };
  return fmt::format(
      "based on earlier runs of the same variant: {}, of the same sequence: {}, on the time per frame: {}, "
      "assumed: {}\n",
      count(CostSource::kSameRun), count(CostSource::kSequence), count(CostSource::kFrames),
      count(CostSource::kAssumed));
}

/// Wall time of tasks as `divide_evenly` makes them: the longest one, and the merge of all runs by one
/// process.
std::string task_text(const std::vector<double>& run_seconds, int tasks) {
  const std::vector<std::size_t> bounds = divide_evenly(run_seconds, tasks);
  const auto at = [&](std::size_t i) { return run_seconds.begin() + static_cast<std::ptrdiff_t>(bounds[i]); };
  double longest_s = 0.0;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i)
    longest_s = std::max(longest_s, std::reduce(at(i), at(i + 1)));
  const double total_s = std::reduce(run_seconds.begin(), run_seconds.end());
  const double merge_s = kMergeSecondsPerRun * static_cast<double>(run_seconds.size());
  const double wall_s = longest_s + merge_s;
  return fmt::format("{:>5} tasks: {:>10.1f} s, of which merging {:>7.1f} s; {:>5.1f} times one worker\n",
                     tasks, wall_s, merge_s, total_s / wall_s);
}

std::string scaling_text(const std::vector<double>& run_seconds, int tasks) {
  std::string text;
  for (int n = 1; n < tasks && !run_seconds.empty(); n *= 2) text += task_text(run_seconds, n);
  return tasks > 0 && !run_seconds.empty() ? text + task_text(run_seconds, tasks) : text;
}

}  // namespace

std::string estimate_text(const PlanMatrix& matrix, const std::filesystem::path& store,
                          const EstimatedWorkers& workers) {
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
  const std::string scaling = scaling_text(seconds, workers.tasks);
  std::ranges::sort(seconds, std::greater<>());
  const int jobs = matrix.plan.kind == RunKind::kTiming ? 1 : workers.jobs;
  return fmt::format("{} of {} runs to execute, {} of one worker; with {} at once: {}\n", seconds.size(),
                     matrix.runs.size(), duration_text(std::reduce(seconds.begin(), seconds.end())), jobs,
                     duration_text(scheduled_seconds(seconds, jobs))) +
         source_text(costs) + scaling;
}

}  // namespace stillpoint::bench
