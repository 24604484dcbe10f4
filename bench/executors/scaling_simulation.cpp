// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/scaling_simulation.h"

#include <algorithm>
#include <cstdint>
#include <set>

#include "bench/plan/execution/run_cost.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

struct Worker {
  double idle_at_s = 0.0;
  std::set<std::size_t> sequences;  ///< that it has prepared
};

/// Uniform in [1 - variation, 1 + variation].
double duration_factor(std::size_t run, double variation) {
  const double uniform = static_cast<double>(mix_bits(static_cast<std::uint64_t>(run)) >> 11) * 0x1p-53;
  return 1.0 + variation * (2.0 * uniform - 1.0);
}

}  // namespace

std::vector<SimulatedRun> repeated(std::span<const SimulatedRun> runs, std::size_t times) {
  std::vector<SimulatedRun> all;
  for (const SimulatedRun& run : runs) all.insert(all.end(), times, run);
  return all;
}

SimulatedPlan simulate_plan(std::span<const SimulatedRun> runs, int workers, int tasks,
                            const ScalingCosts& costs) {
  STILLPOINT_CHECK(!runs.empty() && workers > 0 && tasks > 0);
  std::vector<double> expected_s;
  for (const SimulatedRun& run : runs) expected_s.push_back(run.seconds);
  const std::vector<std::size_t> bounds = divide_evenly(expected_s, tasks);
  std::vector<Worker> pool(static_cast<std::size_t>(workers));
  SimulatedPlan plan{.runs = runs.size()};
  for (std::size_t task = 0; task + 1 < bounds.size(); ++task) {
    Worker& worker = *std::ranges::min_element(pool, {}, &Worker::idle_at_s);
    double preparing_s = 0.0;
    double executing_s = 0.0;
    for (std::size_t run = bounds[task]; run < bounds[task + 1]; ++run) {
      if (worker.sequences.insert(runs[run].sequence).second) preparing_s += costs.prepare_s;
      executing_s += runs[run].seconds * duration_factor(run, costs.variation);
    }
    worker.idle_at_s += costs.task_start_s + preparing_s + executing_s;
    plan.starting_s += costs.task_start_s / workers;
    plan.preparing_s += preparing_s / workers;
    plan.executing_s += executing_s / workers;
  }
  const double end_s = std::ranges::max_element(pool, {}, &Worker::idle_at_s)->idle_at_s;
  plan.waiting_s = end_s - plan.starting_s - plan.preparing_s - plan.executing_s;
  plan.merging_s = costs.merge_s * static_cast<double>(runs.size());
  return plan;
}

}  // namespace stillpoint::bench
