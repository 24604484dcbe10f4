// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/plan/plan_estimate.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "bench/cli/progress.h"
#include "bench/executors/scaling_simulation.h"
#include "bench/plan/execution/run_cost.h"
#include "bench/store/store.h"

namespace stillpoint::bench {
namespace {

/// Plans are multiplied until they have this many runs per simulated worker.
constexpr std::size_t kMaxRunsPerWorker = 64;

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
  const double merge_s = ScalingCosts().merge_s * static_cast<double>(run_seconds.size());
  const double wall_s = longest_s + merge_s;
  return fmt::format("{:>5} tasks: {:>10.1f} s, of which merging {:>7.1f} s; {:>5.1f} times one worker\n",
                     tasks, wall_s, merge_s, total_s / wall_s);
}

std::string scaling_text(const std::vector<double>& run_seconds, int tasks) {
  std::string text;
  for (int n = 1; n < tasks && !run_seconds.empty(); n *= 2) text += task_text(run_seconds, n);
  return tasks > 0 && !run_seconds.empty() ? text + task_text(run_seconds, tasks) : text;
}

/// A table of the plan, 2, 4, 8, ... times as large: wall time, and what it consists of.
std::string simulation_text(const std::vector<SimulatedRun>& runs, const EstimatedWorkers& workers) {
  const int tasks = workers.tasks > 0 ? workers.tasks : workers.simulated;
  const ScalingCosts costs;
  std::string text = fmt::format(
      "simulation of {} workers, {} tasks; s per worker: start of a task {:.1f}, of a sequence {:.1f}; "
      "merging {:.2f} "
      "per run\n{:>8}{:>10}{:>12}{:>10}{:>11}{:>9}{:>9}{:>12}\n",
      workers.simulated, tasks, costs.task_start_s, costs.prepare_s, costs.merge_s, "runs", "wall s",
      "executing", "starting", "preparing", "waiting", "merging", "efficiency");
  const std::size_t limit = kMaxRunsPerWorker * static_cast<std::size_t>(workers.simulated);
  for (std::size_t times = 1; times == 1 || times * runs.size() <= limit; times *= 2) {
    const SimulatedPlan plan = simulate_plan(repeated(runs, times), workers.simulated, tasks, costs);
    text += fmt::format("{:>8}{:>10.1f}{:>12.1f}{:>10.1f}{:>11.1f}{:>9.1f}{:>9.1f}{:>10.1f} %\n", plan.runs,
                        plan.wall_s(), plan.executing_s, plan.starting_s, plan.preparing_s, plan.waiting_s,
                        plan.merging_s, 100.0 * plan.efficiency());
  }
  return text;
}

std::vector<SimulatedRun> simulated_runs(const PlanMatrix& matrix, const std::vector<RunCost>& costs) {
  std::vector<SimulatedRun> runs;
  for (std::size_t i = 0; i < costs.size(); ++i)
    runs.push_back({.seconds = costs[i].seconds, .sequence = matrix.runs[i].sequence});
  return runs;
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
  std::string scaling = scaling_text(seconds, workers.tasks);
  if (workers.simulated > 0 && !seconds.empty())
    scaling += simulation_text(simulated_runs(pending, costs), workers);
  std::ranges::sort(seconds, std::greater<>());
  const int jobs = matrix.plan.kind == RunKind::kTiming ? 1 : workers.jobs;
  return fmt::format("{} of {} runs to execute, {} of one worker; with {} at once: {}\n", seconds.size(),
                     matrix.runs.size(), duration_text(std::reduce(seconds.begin(), seconds.end())), jobs,
                     duration_text(scheduled_seconds(seconds, jobs))) +
         source_text(costs) + scaling;
}

}  // namespace stillpoint::bench
