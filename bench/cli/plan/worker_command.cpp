// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <cstdlib>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/plan/plan_execution.h"
#include "bench/executors/distribution.h"
#include "core/base/counted.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

struct WorkerArguments {
  std::string folder;
  std::string task;
  std::string store;
  int jobs = 1;
};

/// Selects the recorded sequences that were copied with the job.
void use_copied_sequences(const fs::path& folder) {
  const fs::path data = fs::absolute(folder / "data");
  if (fs::is_directory(data)) setenv("STILLPOINT_DATA", data.c_str(), 1);
}

int parse_task(const std::string& text) {
  int task = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), task);
  if (error != std::errc{} || end != text.data() + text.size() || task < 1)
    throw InputError("TASK", "\"" + text + "\" is not the number of a task; expected 1, 2, ...");
  return task;
}

/// Exits with 0 if all runs are stored, with any outcome.
int run(const WorkerArguments& arguments) {
  install_interrupt_handlers();
  use_copied_sequences(arguments.folder);
  const PlanReport report =
      run_task(arguments.folder, parse_task(arguments.task), arguments.jobs, plan_progress());
  std::cout << fmt::format("{} executed, {} cached\n", counted(report.executed, "run"), report.cached);
  return report.interrupted ? kExitInterrupted : kExitOk;
}

int check(const WorkerArguments& arguments) {
  use_copied_sequences(arguments.folder);
  const PlanMatrix matrix = job_matrix(arguments.folder, all_task_keys(arguments.folder));
  std::cout << fmt::format("{} can be executed here\n", counted(matrix.runs.size(), "run"));
  return kExitOk;
}

int wait(const WorkerArguments& arguments) {
  wait_for_workers(arguments.folder);
  return kExitOk;
}

int merge(const WorkerArguments& arguments) {
  if (arguments.store.empty()) throw InputError("--store", "is required");
  const MergeReport report = merge_tasks(arguments.folder, arguments.store);
  std::cout << fmt::format("{} added, {} already present\n", counted(report.added, "run"), report.present);
  for (const std::string& run : report.contradicting)
    std::cout << fmt::format("{}: ended with another result there, which is kept\n", run);
  return report.contradicting.empty() ? kExitOk : kExitFindings;
}

}  // namespace

Command worker_command() {
  const auto arguments = std::make_shared<WorkerArguments>();
  const Option folder{"FOLDER", "Job folder, written by `bench --executor`", &arguments->folder};
  return {.name = "worker",
          .summary = "Execute a task of a plan; called by `bench --executor slurm` and `ssh`",
          .example = "worker run build/bench/store.sqlite.jobs/0123456789abcdef/job 1",
          .subcommands = {
              {.name = "run",
               .summary = "Execute one task into its own store",
               .example = "worker run FOLDER 1 --jobs 2",
               .options = {folder,
                           {"TASK", "Number of the task", &arguments->task},
                           {"--jobs", "Number of concurrent accuracy runs", &arguments->jobs, {1, 1000}}},
               .action = [arguments] { return run(*arguments); }},
              {.name = "check",
               .summary = "Check that this machine has build, configs and data of all runs",
               .example = "worker check FOLDER",
               .options = {folder},
               .action = [arguments] { return check(*arguments); }},
              {.name = "wait",
               .summary = "Wait until no worker uses the folder",
               .example = "worker wait FOLDER",
               .options = {folder},
               .action = [arguments] { return wait(*arguments); }},
              {.name = "merge",
               .summary = "Add the stores of all tasks to a store",
               .example = "worker merge FOLDER --store build/bench/store.sqlite",
               .options = {folder, {"--store", "Database of runs", &arguments->store}},
               .action = [arguments] { return merge(*arguments); }}}};
}

}  // namespace stillpoint::bench
