// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/plan/plan_execution.h"

#include <algorithm>
#include <memory>

#include <spdlog/spdlog.h>

#include "bench/cli/console.h"
#include "bench/executors/remote_executors.h"
#include "bench/process/child_process.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {

PlanHooks plan_progress() {
  const auto rendering = std::make_shared<std::unique_ptr<ProgressLine>>();
  const auto runs = std::make_shared<std::unique_ptr<ProgressLine>>();
  const auto line = [](std::unique_ptr<ProgressLine>& progress, const char* label, std::size_t total,
                       const char* unit) {
    if (!progress) progress = std::make_unique<ProgressLine>(label, total, unit);
    return progress.get();
  };
  return {
      .on_step =
          [rendering, runs](const std::string& step) {
            rendering->reset();
            if (*runs) (*runs)->clear();
            spdlog::info("{}", step);
            if (*runs) (*runs)->draw();
          },
      .on_rendered =
          [rendering, line](int done, int total) {
            line(*rendering, "rendering", static_cast<std::size_t>(total), "frames")
                ->update(static_cast<std::size_t>(done));
          },
      .on_progress = [runs, line](std::size_t done,
                                  std::size_t total) { line(*runs, "bench", total, "runs")->update(done); },
      .stop_requested = interrupt_requested};
}

namespace {

enum class ExecutorKind { kLocal, kSlurm, kSsh };
constexpr auto enum_names(ExecutorKind) {
  return EnumNames<ExecutorKind, 3>{
      {{ExecutorKind::kLocal, "local"}, {ExecutorKind::kSlurm, "slurm"}, {ExecutorKind::kSsh, "ssh"}}};
}

// Of Slurm; and per concurrent task of a host, so that faster hosts execute more.
constexpr int kDefaultTasks = 4;

/// @throws InputError for the first option that is set although the executor does not have it
void require_options(ExecutorKind kind, const ExecutionArguments& arguments) {
  const bool is_ssh = kind == ExecutorKind::kSsh;
  const bool is_local = kind == ExecutorKind::kLocal;
  if (!arguments.hosts.empty() && !is_ssh) throw InputError("--hosts", "requires --executor ssh");
  if (!arguments.ssh_config.empty() && !is_ssh) throw InputError("--ssh-config", "requires --executor ssh");
  if (arguments.hosts.empty() && is_ssh) throw InputError("--executor ssh", "requires --hosts FILE");
  if (arguments.tasks > 0 && is_local) throw InputError("--tasks", "requires --executor slurm or ssh");
  if (!arguments.machine_class.empty() && is_local)
    throw InputError("--machine-class", "requires --executor slurm or ssh");
}

DistributionOptions distribution_of(const std::string& store, const PlanOptions& options,
                                    const ExecutionArguments& arguments) {
  const PlanHooks hooks = plan_progress();
  return {.store = store,
          .tasks = arguments.tasks > 0 ? arguments.tasks : kDefaultTasks,
          .jobs = std::max(1, options.jobs),
          .retry = options.retry,
          .machine_class = arguments.machine_class,
          .on_step = hooks.on_step,
          .stop_requested = hooks.stop_requested};
}

}  // namespace

int local_jobs(int jobs) { return jobs > 0 ? jobs : static_cast<int>(allowed_processors().size()); }

std::vector<Option> execution_options(ExecutionArguments& arguments) {
  return {{"--executor", "Where runs are executed: local, slurm or ssh [local]", &arguments.executor},
          {"--tasks", "Number of tasks with slurm or ssh [4, or 4 per host]", &arguments.tasks, {1, 1000}},
          {"--hosts", "File with one host per line, for ssh", &arguments.hosts},
          {"--ssh-config", "Configuration file of ssh [that of the user]", &arguments.ssh_config},
          {"--machine-class", "Slurm feature or class of hosts; required for timing plans",
           &arguments.machine_class}};
}

PlanReport execute_plan(const PlanMatrix& matrix, const std::string& store, const PlanOptions& options,
                        const ExecutionArguments& arguments) {
  const auto kind = enum_of<ExecutorKind>("--executor", arguments.executor);
  require_options(kind, arguments);
  if (kind == ExecutorKind::kLocal) {
    StoreWriter writer(store);
    return run_plan(matrix, writer, {.jobs = local_jobs(options.jobs), .retry = options.retry},
                    plan_progress());
  }
  DistributionOptions distribution = distribution_of(store, options, arguments);
  if (kind == ExecutorKind::kSlurm)
    return distribute_plan(matrix, distribution, slurm_executor(matrix, distribution));
  const SshOptions ssh{
      .hosts = parse_hosts(eval::read_text_file(arguments.hosts), arguments.hosts, executable_path()),
      .config = arguments.ssh_config};
  if (arguments.tasks == 0) {
    distribution.tasks = 0;
    for (const Host& host : ssh.hosts) distribution.tasks += kDefaultTasks * host.tasks;
  }
  return distribute_plan(matrix, distribution, ssh_executor(matrix, distribution, ssh));
}

}  // namespace stillpoint::bench
