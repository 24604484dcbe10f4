// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint history` executes a plan with the program of each commit of a range.
#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/plan/plan_execution.h"
#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/plan_matrix.h"
#include "bench/store/store.h"
#include "bench/systems/source_builds.h"
#include "core/base/counted.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

struct HistoryArguments {
  std::string range;
  std::string system;  ///< empty: this odometry
  std::string plan = "quick";
  std::string store = "build/bench/store.sqlite";
  std::string builds;
  int max_commits = 0;   ///< 0 = all
  int jobs = 0;          ///< 0 = all processors
  int keep_builds = -1;  ///< -1 = all
};

/// What became of the commits.
struct HistoryCounts {
  std::size_t stored = 0;  ///< before
  std::size_t executed = 0;
  std::size_t failed_builds = 0;
  std::size_t failed_runs = 0;
  double seconds = 0.0;  ///< of the executed ones and the failed builds
};

/// The system of a history, and its runs on the sequences of the plan.
class HistorySystem {
 public:
  explicit HistorySystem(const HistoryArguments& arguments) {
    BenchPlan plan = load_plan(arguments.plan);
    if (arguments.system.empty()) {
      plan.systems.clear();
      matrix_ = expand_plan(plan, "", {});
    } else {
      matrix_ = expand_plan(plan_of_system(std::move(plan), arguments.system), "", {});
      external_ = matrix_.systems.front();
    }
  }

  [[nodiscard]] SourceBuilds builds(const std::string& folder) const {
    return external_ ? SourceBuilds(*external_, folder, interrupt_requested)
                     : SourceBuilds(own_source(), ".", folder, interrupt_requested);
  }

  /// The runs of a commit. Their keys do not depend on the build.
  [[nodiscard]] PlanMatrix runs(const SourceCommit& commit, const SourceBuild& build) const {
    return external_ ? with_version(matrix_, built_system(*external_, commit, build), commit.time)
                     : with_program(matrix_, {build.program, commit.hash, commit.time});
  }

  /// Without a build.
  [[nodiscard]] const PlanMatrix& matrix() const { return matrix_; }

  /// Name in the dashboard.
  [[nodiscard]] std::string name() const { return external_ ? external_->name : "stillpoint"; }

 private:
  PlanMatrix matrix_;
  std::optional<ExternalSystem> external_;
};

/// Outcomes of the stored runs of a matrix.
struct StoredOutcomes {
  std::size_t ended = 0;   ///< runs that are not executed again
  std::size_t failed = 0;  ///< of these
};

using OutcomeOfRun = std::map<std::string, Outcome>;  ///< by the key of the run

/// @return the outcomes of all runs; none if there is no store yet
OutcomeOfRun read_outcomes(const fs::path& store) {
  OutcomeOfRun outcomes;
  if (!fs::exists(store)) return outcomes;
  for (const StoredRun& run : Store(store).run_headers()) outcomes[run.key] = run.outcome;
  return outcomes;
}

StoredOutcomes stored_outcomes(const PlanMatrix& matrix, const OutcomeOfRun& stored) {
  StoredOutcomes outcomes;
  for (const std::string& key : matrix.keys) {
    const auto found = stored.find(key);
    if (found == stored.end() || found->second == Outcome::kBadData) continue;
    ++outcomes.ended;
    outcomes.failed += found->second == Outcome::kOk ? 0 : 1;
  }
  return outcomes;
}

/// Measures the commits one by one.
class HistoryRunner {
 public:
  HistoryRunner(const HistoryArguments& arguments, const HistorySystem& system)
      : arguments_(arguments), system_(system), builds_(system.builds(arguments.builds)) {
    require_unchanged_sequences(sequences_, system_.matrix());
  }

  [[nodiscard]] std::vector<SourceCommit> commits() const {
    return builds_.commits(arguments_.range, arguments_.max_commits);
  }

  HistoryCounts run(const std::vector<SourceCommit>& commits) {
    const OutcomeOfRun stored = read_outcomes(arguments_.store);
    std::vector<SourceCommit> missing;
    for (const SourceCommit& commit : commits) {
      if (is_stored(commit, stored)) {
        ++counts_.stored;
      } else {
        missing.push_back(commit);
      }
    }
    for (std::size_t i = 0; i < missing.size() && !interrupt_requested(); ++i) {
      spdlog::info("commit {} of {}: {} {}", i + 1, missing.size(), missing[i].short_hash(),
                   missing[i].subject);
      const Stopwatch time;
      measure(missing[i]);
      remove_builds();
      counts_.seconds += time.seconds();
      const std::size_t left = missing.size() - i - 1;
      if (left > 0 && !interrupt_requested())
        spdlog::info("{} left, about {}", counted(static_cast<std::size_t>(left), "commit"),
                     duration_text(counts_.seconds / static_cast<double>(i + 1) * static_cast<double>(left)));
    }
    remove_builds();
    return counts_;
  }

 private:
  /// Keeps as many builds as the user wants to.
  void remove_builds() const {
    if (arguments_.keep_builds >= 0) builds_.keep_latest(static_cast<std::size_t>(arguments_.keep_builds));
  }

  /// Whether all runs of a commit were executed before: it is not built then.
  bool is_stored(const SourceCommit& commit, const OutcomeOfRun& stored) {
    const PlanMatrix matrix = system_.runs(commit, {});
    const StoredOutcomes outcomes = stored_outcomes(matrix, stored);
    const bool is_complete = outcomes.ended >= matrix.runs.size();
    if (is_complete) counts_.failed_runs += outcomes.failed;
    return is_complete;
  }

  void measure(const SourceCommit& commit) {
    if (builds_.is_busy()) spdlog::info(kWaitForBuild);
    const SourceBuild build = builds_.build(commit);
    if (interrupt_requested()) return;
    if (!build.failure.empty()) {
      ++counts_.failed_builds;
      spdlog::warn("{}: {}", commit.short_hash(), build.failure);
      return;
    }
    const PlanMatrix matrix = system_.runs(commit, build);
    require_unchanged_sequences(sequences_, matrix);
    const PlanReport report = execute_plan(matrix, arguments_.store, {.jobs = arguments_.jobs}, {});
    if (report.interrupted) return;
    ++counts_.executed;
    counts_.failed_runs += stored_outcomes(matrix, read_outcomes(arguments_.store)).failed;
  }

  const HistoryArguments& arguments_;
  const HistorySystem& system_;
  SourceBuilds builds_;
  SequenceWatch sequences_;
  HistoryCounts counts_;
};

int history(const HistoryArguments& arguments) {
  install_interrupt_handlers();
  const HistorySystem system(arguments);
  HistoryRunner runner(arguments, system);
  const std::vector<SourceCommit> commits = runner.commits();
  const HistoryCounts counts = runner.run(commits);
  std::cout << fmt::format(
      "{}: {} executed, {} stored before, {} not built; {}; store {}\n", counted(commits.size(), "commit"),
      counts.executed, counts.stored, counts.failed_builds,
      counted(static_cast<std::size_t>(counts.failed_runs), "failed run"), arguments.store);
  if (interrupt_requested()) {
    std::cout << "interrupted; run the same command again to continue\n";
    return kExitInterrupted;
  }
  std::cout << fmt::format("see: stillpoint dashboard {} --out DIR --system {}\n", arguments.store,
                           system.name());
  return counts.failed_builds + counts.failed_runs > 0 ? kExitFindings : kExitOk;
}

}  // namespace

Command history_command() {
  const auto arguments = std::make_shared<HistoryArguments>();
  return {
      .name = "history",
      .summary =
          "Execute a plan with the program of each commit of a range, the newest first; run it again to "
          "continue",
      .example = "history v1.0..HEAD --system my_slam.toml --plan quick --store history.sqlite",
      .options = {{"RANGE", "Commits as for git: OLD..NEW; along first parents", &arguments->range},
                  {"--system",
                   "Description with the table [source] [this odometry; its repository is the current "
                   "folder]",
                   &arguments->system},
                  {"--plan", "Sequences, faults and repetitions [quick]", &arguments->plan},
                  {"--store", "Database of runs [build/bench/store.sqlite]", &arguments->store},
                  {"--builds", kBuildsHelp, &arguments->builds},
                  {"--keep-builds",
                   "Number of builds of this repository that are kept, the latest ones; 0 removes all [all]",
                   &arguments->keep_builds,
                   {0, 1000000}},
                  {"--max-commits",
                   "Only the newest commits of the range [all]",
                   &arguments->max_commits,
                   {1, 1000000}},
                  {"--jobs", "Number of concurrent accuracy runs [processors]", &arguments->jobs, {1, 1000}}},
      .action = [arguments] { return history(*arguments); }};
}

}  // namespace stillpoint::bench
