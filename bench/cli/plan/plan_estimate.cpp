// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/plan/plan_estimate.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/cli/console.h"
#include "bench/store/store.h"
#include "core/base/counted.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Plans are multiplied until they have this many runs per simulated worker.
constexpr std::size_t kMaxRunsPerWorker = 64;

/// How many expected durations have the source.
std::ptrdiff_t count_of(const PlanEstimate& estimate, CostSource source) {
  return std::ranges::count(estimate.pending, source, &RunCost::source);
}

TaskEstimate task_estimate(const std::vector<double>& run_seconds, int tasks) {
  const std::vector<std::size_t> bounds = divide_evenly(run_seconds, tasks);
  const auto at = [&](std::size_t i) { return run_seconds.begin() + static_cast<std::ptrdiff_t>(bounds[i]); };
  double longest_s = 0.0;
  for (std::size_t i = 0; i + 1 < bounds.size(); ++i)
    longest_s = std::max(longest_s, std::reduce(at(i), at(i + 1)));
  const double total_s = std::reduce(run_seconds.begin(), run_seconds.end());
  const double merge_s = ScalingCosts().merge_s * static_cast<double>(run_seconds.size());
  const double wall_s = longest_s + merge_s;
  return {.tasks = tasks, .wall_s = wall_s, .merge_s = merge_s, .speedup = total_s / wall_s};
}

/// The plan, 2, 4, 8, ... times as large.
void add_simulation(const PlanMatrix& pending, const EstimatedWorkers& workers, PlanEstimate& estimate) {
  estimate.simulated_workers = workers.simulated;
  estimate.simulated_tasks = workers.tasks > 0 ? workers.tasks : workers.simulated;
  std::vector<SimulatedRun> runs;
  for (std::size_t i = 0; i < estimate.pending.size(); ++i)
    runs.push_back({.seconds = estimate.pending[i].seconds, .sequence = pending.runs[i].sequence});
  const std::size_t limit = kMaxRunsPerWorker * static_cast<std::size_t>(workers.simulated);
  for (std::size_t times = 1; times == 1 || times * runs.size() <= limit; times *= 2)
    estimate.simulation.push_back(
        simulate_plan(repeated(runs, times), workers.simulated, estimate.simulated_tasks, {}));
}

std::string simulation_text(const PlanEstimate& estimate) {
  const ScalingCosts costs;
  std::string text = fmt::format(
      "simulation of {} workers, {} tasks; s per worker: start of a task {:.1f}, of a sequence {:.1f}; "
      "merging {:.2f} "
      "per run\n{:>8}{:>10}{:>12}{:>10}{:>11}{:>9}{:>9}{:>12}\n",
      estimate.simulated_workers, estimate.simulated_tasks, costs.task_start_s, costs.prepare_s,
      costs.merge_s, "runs", "wall s", "executing", "starting", "preparing", "waiting", "merging",
      "efficiency");
  for (const SimulatedPlan& plan : estimate.simulation)
    text += fmt::format("{:>8}{:>10.1f}{:>12.1f}{:>10.1f}{:>11.1f}{:>9.1f}{:>9.1f}{:>10.1f} %\n", plan.runs,
                        plan.wall_s(), plan.executing_s, plan.starting_s, plan.preparing_s, plan.waiting_s,
                        plan.merging_s, 100.0 * plan.efficiency());
  return text;
}

}  // namespace

PlanEstimate estimate_plan(const PlanMatrix& matrix, const std::filesystem::path& store,
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
  PlanEstimate estimate{.runs = matrix.runs.size(),
                        .pending = expected_costs(pending, history),
                        .jobs = matrix.plan.kind == RunKind::kTiming ? 1 : workers.jobs};
  std::vector<double> seconds;
  seconds.reserve(estimate.pending.size());
  for (const RunCost& cost : estimate.pending) seconds.push_back(cost.seconds);
  if (!seconds.empty()) {
    for (int n = 1; n < workers.tasks; n *= 2) estimate.tasks.push_back(task_estimate(seconds, n));
    if (workers.tasks > 0) estimate.tasks.push_back(task_estimate(seconds, workers.tasks));
    if (workers.simulated > 0) add_simulation(pending, workers, estimate);
  }
  std::ranges::sort(seconds, std::greater<>());
  estimate.one_worker_s = std::reduce(seconds.begin(), seconds.end());
  estimate.wall_s = scheduled_seconds(seconds, estimate.jobs);
  return estimate;
}

std::string estimate_text(const PlanEstimate& estimate) {
  std::string text = fmt::format(
      "{} of {} to execute, {} of one worker; with {} at once: {}\n"
      "based on earlier runs of the same variant: {}, of the same sequence: {}, on the time per frame: {}, "
      "assumed: {}\n",
      estimate.pending.size(), counted(estimate.runs, "run"), duration_text(estimate.one_worker_s),
      estimate.jobs, duration_text(estimate.wall_s), count_of(estimate, CostSource::kSameRun),
      count_of(estimate, CostSource::kSequence), count_of(estimate, CostSource::kFrames),
      count_of(estimate, CostSource::kAssumed));
  for (const TaskEstimate& task : estimate.tasks)
    text += fmt::format("{:>5} tasks: {:>10.1f} s, of which merging {:>7.1f} s; {:>5.1f} times one worker\n",
                        task.tasks, task.wall_s, task.merge_s, task.speedup);
  return estimate.simulation.empty() ? text : text + simulation_text(estimate);
}

std::string estimate_json(const PlanEstimate& estimate) {
  Json tasks = Json::array();
  for (const TaskEstimate& task : estimate.tasks)
    tasks.push_back({{"tasks", task.tasks},
                     {"wall_s", task.wall_s},
                     {"merge_s", task.merge_s},
                     {"speedup", task.speedup}});
  Json simulation = Json::array();
  for (const SimulatedPlan& plan : estimate.simulation)
    simulation.push_back({{"workers", estimate.simulated_workers},
                          {"tasks", estimate.simulated_tasks},
                          {"runs", plan.runs},
                          {"wall_s", plan.wall_s()},
                          {"executing_s", plan.executing_s},
                          {"starting_s", plan.starting_s},
                          {"preparing_s", plan.preparing_s},
                          {"waiting_s", plan.waiting_s},
                          {"merging_s", plan.merging_s},
                          {"efficiency", plan.efficiency()}});
  const Json json = {{"schema", 1},
                     {"runs", estimate.runs},
                     {"pending_runs", estimate.pending.size()},
                     {"one_worker_s", estimate.one_worker_s},
                     {"jobs", estimate.jobs},
                     {"wall_s", estimate.wall_s},
                     {"based_on",
                      {{"same_variant", count_of(estimate, CostSource::kSameRun)},
                       {"same_sequence", count_of(estimate, CostSource::kSequence)},
                       {"time_per_frame", count_of(estimate, CostSource::kFrames)},
                       {"assumed", count_of(estimate, CostSource::kAssumed)}}},
                     {"tasks", std::move(tasks)},
                     {"simulation", std::move(simulation)}};
  return json.dump(2) + "\n";
}

}  // namespace stillpoint::bench
