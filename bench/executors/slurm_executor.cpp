// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/slurm_executor.h"

#include <algorithm>
#include <cctype>
#include <memory>
#include <set>
#include <sstream>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/executors/job_folder.h"
#include "bench/executors/tool.h"
#include "bench/process/child_process.h"
#include "bench/record/output_folder.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

// Slurm passes the words after the script to it as they are, so nothing is inserted into the texts.
constexpr const char* kTaskScript =
    "#!/bin/sh\n"
    "# task.sh PROGRAM FOLDER JOBS: executes the array task of a plan\n"
    "exec \"$1\" worker run \"$2\" \"$SLURM_ARRAY_TASK_ID\" --jobs \"$3\"\n";
constexpr const char* kMergeScript =
    "#!/bin/sh\n"
    "# merge.sh PROGRAM FOLDER STORE: merges the stores of all tasks\n"
    "exec \"$1\" worker merge \"$2\" --store \"$3\"\n";

/// The jobs of one plan.
class SlurmJobs {
 public:
  SlurmJobs(const PlanMatrix& matrix, const DistributionOptions& options)
      : options_(options), kind_(matrix.plan.kind), folder_(job_folder(matrix.plan, options.store)) {
    // sbatch replaces %a etc. in names of output files, and a backslash prevents that.
    if (folder_.string().find_first_of("%\\\n") != std::string::npos)
      throw InputError(options.store.string(),
                       "Slurm replaces characters of its path; use one without % and \\");
  }

  void collect() const {
    const std::vector<std::string> active = active_jobs();
    if (!active.empty()) {
      report(fmt::format("wait for Slurm jobs {} of an earlier call", fmt::join(active, ", ")));
      submit_merge(active);
    }
    if (stopped()) return;
    fs::create_directories(folder_ / "job");
    merge_tasks(folder_ / "job", options_.store);
  }

  void execute(int tasks) const {
    write_files(folder_, {{"task.sh", kTaskScript}, {"merge.sh", kMergeScript}});
    std::vector<std::string> arguments = {"--requeue",
                                          fmt::format("--array=1-{}", tasks),
                                          fmt::format("--cpus-per-task={}", options_.jobs),
                                          "--job-name=stillpoint",
                                          "--output=" + (folder_ / "task-%a.log").string(),
                                          "--open-mode=append"};
    if (kind_ == RunKind::kTiming) arguments.emplace_back("--exclusive");
    if (!options_.machine_class.empty()) arguments.push_back("--constraint=" + options_.machine_class);
    const std::string array = submit(
        arguments, {folder_ / "task.sh", executable_path(), folder_ / "job", std::to_string(options_.jobs)});
    write_files(folder_, {{"array-job", array + "\n"}});
    report(fmt::format("Slurm job array {} with {} tasks; logs in {}", array, tasks, folder_.string()));
    submit_merge({array});
  }

 private:
  [[nodiscard]] bool stopped() const { return options_.stop_requested && options_.stop_requested(); }
  void report(const std::string& step) const {
    if (options_.on_step) options_.on_step(step);
  }

  /// Submits a job. @return its id
  [[nodiscard]] std::string submit(std::vector<std::string> options,
                                   const std::vector<std::string>& command) const {
    options.insert(options.begin(), "--parsable");
    options.insert(options.end(), command.begin(), command.end());
    const std::string output =
        require_tool({.program = "sbatch", .arguments = options, .stop_requested = options_.stop_requested});
    const std::string id = output.substr(0, output.find_first_of(";\n"));  // "ID" or "ID;CLUSTER"
    if (id.empty() || !std::ranges::all_of(id, [](unsigned char c) { return std::isdigit(c) != 0; }))
      throw InputError("sbatch", "printed no job id: " + output);
    return id;
  }

  /// Submits the job that merges the stores after all `jobs` ended, and waits for it. The caller merges as
  /// well and notices if the job did not.
  void submit_merge(const std::vector<std::string>& jobs) const {
    const std::vector<std::string> arguments = {"--parsable",
                                                "--wait",
                                                "--job-name=stillpoint-merge",
                                                "--output=" + (folder_ / "merge.log").string(),
                                                fmt::format("--dependency=afterany:{}", fmt::join(jobs, ":")),
                                                folder_ / "merge.sh",
                                                executable_path(),
                                                folder_ / "job",
                                                fs::absolute(options_.store)};
    static_cast<void>(
        call_tool({.program = "sbatch", .arguments = arguments, .stop_requested = options_.stop_requested}));
    if (stopped()) report("the Slurm jobs continue; the same command waits for them, scancel ends them");
  }

  /// The array job of an earlier call, if it has not ended.
  [[nodiscard]] std::vector<std::string> active_jobs() const {
    const fs::path file = folder_ / "array-job";
    if (!fs::exists(file)) return {};
    std::string id = eval::read_text_file(file);
    while (id.ends_with('\n')) id.pop_back();
    // squeue fails for jobs that Slurm has forgotten; they have ended.
    const ToolResult queue =
        call_tool({.program = "squeue", .arguments = {"--noheader", "--format=%F", "--jobs=" + id}});
    std::istringstream rows(queue.output);
    std::set<std::string> active;
    for (std::string row; rows >> row;) active.insert(row);
    return queue.exit_code == 0 ? std::vector<std::string>(active.begin(), active.end())
                                : std::vector<std::string>{};
  }

  DistributionOptions options_;
  RunKind kind_;
  fs::path folder_;
};

}  // namespace

Executor slurm_executor(const PlanMatrix& matrix, const DistributionOptions& options) {
  const auto jobs = std::make_shared<const SlurmJobs>(matrix, options);
  return {.collect = [jobs] { jobs->collect(); }, .execute = [jobs](int tasks) { jobs->execute(tasks); }};
}

}  // namespace stillpoint::bench
