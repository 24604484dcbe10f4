// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/distribution.h"

#include <array>

#include <fmt/format.h>
#include <unistd.h>

#include "bench/executors/host_list.h"
#include "bench/executors/job_folder.h"
#include "bench/plan/execution/plan_boxes.h"
#include "bench/plan/execution/run_cost.h"
#include "bench/process/file_lock.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

bool is_available(const PlanMatrix& matrix, const PlannedRun& run) {
  return matrix.sequences[run.sequence].unavailable_reason.empty();
}

/// The matrix with its runs that are available and not completed.
PlanMatrix pending_runs(PlanMatrix matrix, const StoreWriter& writer) {
  std::erase_if(matrix.runs, [&](const PlannedRun& run) {
    return !is_available(matrix, run) || writer.is_done(run_key(run.identity));
  });
  return matrix;
}

/// Keys of the runs of each task: consecutive runs of the plan with about equal expected duration.
std::vector<std::vector<std::string>> divide_runs(const PlanMatrix& pending,
                                                  const DistributionOptions& options) {
  std::vector<double> seconds;
  for (const RunCost& cost : expected_costs(pending, Store(options.store).runs()))
    seconds.push_back(cost.seconds);
  const std::vector<std::size_t> bounds = divide_evenly(seconds, options.tasks);
  std::vector<std::vector<std::string>> tasks(bounds.size() - 1);
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    for (std::size_t run = bounds[task]; run < bounds[task + 1]; ++run)
      tasks[task].push_back(run_key(pending.runs[run].identity));
  }
  return tasks;
}

void require_class(const PlanMatrix& matrix, const DistributionOptions& options) {
  if (!options.machine_class.empty() && !is_host_word(options.machine_class))
    throw InputError("--machine-class",
                     "\"" + options.machine_class + "\" must consist of letters, digits and _ . -");
  if (matrix.plan.kind == RunKind::kTiming && options.machine_class.empty())
    throw InputError("--machine-class",
                     "is required for a timing plan, as times of different machines are not comparable");
}

PlanReport report_of(const PlanMatrix& matrix, const StoreWriter& writer) {
  PlanReport report;
  for (const PlannedRun& run : matrix.runs) {
    if (!is_available(matrix, run))
      ++report.missing;
    else if (writer.is_done(run_key(run.identity)))
      ++report.cached;
  }
  return report;
}

}  // namespace

fs::path job_folder(const BenchPlan& plan, const fs::path& store) {
  fs::create_directories(fs::absolute(store).parent_path());
  const fs::path file = fs::weakly_canonical(fs::absolute(store));
  const std::string identity = host_name() + '\n' + file.string() + '\n' + plan.name;
  fs::path folder = file.string() + ".jobs/" + hash_text(content_hash(identity));
  fs::create_directories(folder);
  return folder;
}

PlanReport distribute_plan(const PlanMatrix& matrix, const DistributionOptions& options,
                           const Executor& executor) {
  require_recorded_boxes(matrix);
  require_class(matrix, options);
  const fs::path folder = job_folder(matrix.plan, options.store);
  const FileLock lock(folder / "calling", LockKind::kExclusive);
  executor.collect();
  std::size_t cached = 0;
  std::vector<std::vector<std::string>> tasks;
  {
    StoreWriter writer(options.store);
    prepare_store(matrix, writer, {.retry = options.retry});
    cached = report_of(matrix, writer).cached;
    const PlanMatrix pending = pending_runs(matrix, writer);
    if (!pending.runs.empty()) tasks = divide_runs(pending, options);
  }
  if (!tasks.empty() && !options.stop_requested()) {
    write_job(folder / "job", matrix.plan, tasks);
    executor.execute(static_cast<int>(tasks.size()));
    if (!options.stop_requested()) executor.collect();
  }
  PlanReport report = report_of(matrix, StoreWriter(options.store));
  report.executed = report.cached - cached;
  report.cached = cached;
  report.interrupted = options.stop_requested();
  return report;
}

}  // namespace stillpoint::bench
