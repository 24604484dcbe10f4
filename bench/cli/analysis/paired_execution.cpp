// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/paired_execution.h"

#include <set>

#include <spdlog/spdlog.h>

#include "bench/cli/console.h"
#include "bench/plan/execution/plan_runner.h"
#include "bench/store/store.h"
#include "core/base/counted.h"

namespace stillpoint::bench {
namespace {

/// The runs of a build that belong to a plan; the store may contain those of other comparisons.
std::vector<StoredRun> planned_runs(const Store& store, const PlanMatrix& matrix, const std::string& build) {
  const std::set<std::string> keys(matrix.keys.begin(), matrix.keys.end());
  std::vector<StoredRun> runs = store.runs({.build = build});
  std::erase_if(runs, [&](const StoredRun& run) { return !keys.contains(run.key); });
  return runs;
}

}  // namespace

ExecutedPairs execute_pairs(const PlanMatrix& matrix, const std::string& store, const BuildPair& builds) {
  const int pairs = matrix.plan.repetitions;
  spdlog::info("{} of each of {}", counted(static_cast<std::size_t>(pairs), "pair"),
               counted(matrix.runs.size() / (2 * static_cast<std::size_t>(pairs)), "run"));
  const PlanHooks hooks{.on_step = [](const std::string& step) { spdlog::debug("{}", step); },
                        .stop_requested = interrupt_requested};
  {
    StoreWriter writer(store);
    static_cast<void>(run_plan(matrix, writer, {}, hooks));
    require_uninterrupted();
  }
  const Store executed(store);
  return {planned_runs(executed, matrix, builds.base), planned_runs(executed, matrix, builds.head)};
}

}  // namespace stillpoint::bench
