// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint bisect` finds the commit of a range that changed a metric.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "bench/analysis/comparison.h"
#include "bench/analysis/search/bisection.h"
#include "bench/cli/analysis/paired_execution.h"
#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/config/spelling.h"
#include "bench/model/metrics.h"
#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/plan_matrix.h"
#include "bench/systems/source_builds.h"
#include "core/base/counted.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kPairs = 8;  // of the first comparison that tests a change

struct BisectArguments {
  std::string metric;
  std::string range;
  std::string system;  ///< empty: this odometry
  std::string plan = "quick";
  std::string out = "build/bench/bisect";
  std::string builds;
  int max_pairs = 64;
};

/// GOOD and BAD of "GOOD..BAD".
std::pair<std::string, std::string> ends_of(const std::string& range) {
  const std::size_t dots = range.find("..");
  if (dots == std::string::npos || dots == 0 || range.substr(dots).starts_with("..."))
    throw InputError(range, "is no range; write GOOD..BAD");
  const std::string bad = range.substr(dots + 2);
  return {range.substr(0, dots), bad.empty() ? "HEAD" : bad};
}

/// @throws InputError if runs succeeded, and none has a value of the metric that can be compared
void require_metric(const ExecutedPairs& executed, const std::string& metric) {
  std::set<std::string> names;
  for (const auto* runs : {&executed.base, &executed.head}) {
    for (const StoredRun& run : *runs) {
      for (const Metric& value : run.metrics) {
        if (gated_metric(without_protocol(value.name)) != nullptr) names.insert(value.name);
      }
      for (const ModuleCost& cost : run.costs) names.insert(cost.module);
    }
  }
  if (names.empty() || names.contains(metric) || metric == metric_id::kFailedRuns) return;
  const std::vector<std::string> known(names.begin(), names.end());
  throw InputError(
      "METRIC",
      fmt::format("\"{}\" is no metric of these runs that can be compared{}; they have: "
                  "{}, {}",
                  metric, suggestion(metric, known), fmt::join(known, ", "), metric_id::kFailedRuns));
}

/// Builds versions and compares them in pairs, each pair of versions in a store of its own: what was executed
/// is not executed again, and the times of one comparison are interleaved.
class VersionComparer {
 public:
  explicit VersionComparer(const BisectArguments& arguments)
      : arguments_(arguments),
        external_(arguments.system.empty() ? std::nullopt
                                           : std::optional(load_external_system(arguments.system))),
        source_(external_ ? SourceBuilds(*external_, arguments.builds, interrupt_requested)
                          : SourceBuilds(own_source(), ".", arguments.builds, interrupt_requested)),
        runs_(external_ ? single_system_runs(load_plan(arguments.plan), arguments.system)
                        : single_runs(load_plan(arguments.plan))) {
    if (runs_.runs.empty())
      throw InputError(arguments.plan, "has no run of the system; see `stillpoint plan show`");
    // Few pairs first: they are sufficient for an exact change.
    for (int pairs = static_cast<int>(exact_repetitions(runs_.runs.front().identity, runs_.runs.size()));
         pairs < arguments.max_pairs; pairs = pairs < kPairs ? kPairs : 2 * pairs)
      numbers_of_pairs_.push_back(pairs);
    numbers_of_pairs_.push_back(arguments.max_pairs);
    require_unchanged_sequences(sequences_, runs_);
    const auto [good, bad] = ends_of(arguments.range);
    commits_ = {source_.commit(good)};
    for (SourceCommit& commit : source_.between(commits_.front(), source_.commit(bad)))
      commits_.push_back(std::move(commit));
  }

  [[nodiscard]] const std::vector<SourceCommit>& commits() const { return commits_; }
  [[nodiscard]] std::size_t new_builds() const { return new_builds_; }
  [[nodiscard]] std::size_t versions() const { return versions_; }
  /// A few, 8, 16, ... up to the limit.
  [[nodiscard]] const std::vector<int>& numbers_of_pairs() const { return numbers_of_pairs_; }

  /// @return nullopt if it cannot be built
  std::optional<SourceBuild> build(std::size_t version) {
    const SourceCommit& commit = commits_[version];
    spdlog::info("build {} {}", commit.short_hash(), commit.subject);
    SourceBuild build = built(commit);
    ++versions_;
    new_builds_ += build.cached ? 0 : 1;
    if (build.failure.empty()) return build;
    spdlog::warn("{}: {}", commit.short_hash(), build.failure);
    return std::nullopt;
  }

  /// @param base, head indices of versions that are built
  Comparison compare(std::size_t base, std::size_t head, int pairs) {
    const SourceCommit& base_commit = commits_[base];
    const SourceCommit& head_commit = commits_[head];
    require_unchanged_sequences(sequences_, runs_);
    fs::create_directories(arguments_.out);
    const fs::path store =
        fs::path(arguments_.out) / (base_commit.short_hash() + "-" + head_commit.short_hash() + ".sqlite");
    const SourceBuild base_build = built(base_commit);
    const SourceBuild head_build = built(head_commit);
    const ExecutedPairs executed =
        execute(base_build, head_build, {base_commit, head_commit}, {pairs, store.string()});
    require_metric(executed, arguments_.metric);
    return compare_runs(with_metric_only(executed.base, arguments_.metric),
                        with_metric_only(executed.head, arguments_.metric), CompareSource::kPrograms);
  }

 private:
  /// @throws Interrupted
  [[nodiscard]] SourceBuild built(const SourceCommit& commit) const {
    if (source_.is_busy()) spdlog::info(kWaitForBuild);
    SourceBuild build = source_.build(commit);
    require_uninterrupted();
    return build;
  }

  struct CommitPair {
    SourceCommit base;
    SourceCommit head;
  };
  struct PairCount {
    int pairs;
    std::string store;
  };

  [[nodiscard]] ExecutedPairs execute(const SourceBuild& base, const SourceBuild& head,
                                      const CommitPair& commits, const PairCount& count) const {
    if (!external_) {
      ProgramPair programs{base.program, head.program};
      programs.perturbed = accept_perturbation(programs);
      return execute_pairs(paired_plan(runs_, programs, count.pairs), count.store,
                           {programs.base_build(), programs.head_build()});
    }
    const SystemPair systems{built_system(*external_, commits.base, base),
                             built_system(*external_, commits.head, head)};
    return execute_pairs(paired_systems(runs_, systems, count.pairs), count.store,
                         {system_build(systems.base, true), system_build(systems.head, false)});
  }

  const BisectArguments& arguments_;
  std::optional<ExternalSystem> external_;
  SourceBuilds source_;
  PlanMatrix runs_;
  SequenceWatch sequences_;
  std::vector<SourceCommit> commits_;  ///< from the first version to the last one
  std::vector<int> numbers_of_pairs_;
  std::size_t versions_ = 0;
  std::size_t new_builds_ = 0;
};

/// The change between two versions, with as many pairs as it needs; prints it.
/// @return nullopt if it is not significant with the most pairs
std::optional<FollowedChange> find_change(VersionComparer& versions, const BisectArguments& arguments,
                                          std::size_t base, std::size_t head) {
  for (const int pairs : versions.numbers_of_pairs()) {
    const Comparison comparison = versions.compare(base, head, pairs);
    std::optional<FollowedChange> change =
        followed_change(comparison, arguments.metric, versions.numbers_of_pairs().size());
    if (!change) continue;
    std::cout << fmt::format("{}: {}\n", arguments.metric, change_text(comparison, *change));
    return change;
  }
  return std::nullopt;
}

const char* side_name(VersionSide side) {
  switch (side) {
    case VersionSide::kBefore:
      return "before the change";
    case VersionSide::kAfter:
      return "after the change";
    case VersionSide::kUndecided:
      return "undecided";
    case VersionSide::kUntestable:
      return "not testable";
  }
  return "";
}

VersionSide side_of_version(VersionComparer& versions, const FollowedChange& whole, std::size_t version) {
  VersionSide side = VersionSide::kUntestable;
  int used = 0;
  if (versions.build(version)) {
    for (const int pairs : versions.numbers_of_pairs()) {
      used = pairs;
      side = side_of(versions.compare(0, version, pairs), whole);
      if (side != VersionSide::kUndecided) break;
    }
  }
  std::cout << fmt::format("{} {}, {}: {}\n", versions.commits()[version].short_hash(), side_name(side),
                           counted(static_cast<std::size_t>(used), "pair"),
                           versions.commits()[version].subject);
  return side;
}

/// The commits between the two ends of a search that did not end at one commit.
int report_rest(const VersionComparer& versions, const Bisection& found) {
  std::cout << fmt::format("the change is in one of {} commits that are undecided or not testable:\n",
                           found.first_after - found.last_before);
  for (std::size_t i = found.last_before + 1; i <= found.first_after; ++i)
    std::cout << fmt::format("  {} {}\n", versions.commits()[i].hash, versions.commits()[i].subject);
  std::cout << "raise --max-pairs, or use a plan with more sequences\n";
  return kExitInconclusive;
}

int search(VersionComparer& versions, const BisectArguments& arguments) {
  const std::size_t last = versions.commits().size() - 1;
  for (const std::size_t end : {std::size_t{0}, last}) {
    if (!versions.build(end))
      throw InputError(versions.commits()[end].short_hash(),
                       "cannot be built; choose an end of the range that can");
  }
  const std::optional<FollowedChange> whole = find_change(versions, arguments, 0, last);
  if (!whole) {
    std::cout << fmt::format("{} did not {} from {} to {} with {}; choose another metric, range or plan\n",
                             arguments.metric,
                             arguments.metric == metric_id::kFailedRuns ? "increase" : "change",
                             versions.commits().front().short_hash(), versions.commits().back().short_hash(),
                             counted(static_cast<std::size_t>(arguments.max_pairs), "pair"));
    return kExitInconclusive;
  }
  const Bisection found = bisect_versions(versions.commits().size(), [&](std::size_t version) {
    return side_of_version(versions, *whole, version);
  });
  if (!found.is_single()) return report_rest(versions, found);
  const SourceCommit& commit = versions.commits()[found.first_after];
  std::cout << fmt::format("first commit with the change: {} ({}) {}\n", commit.hash, commit.time,
                           commit.subject);
  if (last == 1) {
    std::cout << fmt::format("the only commit of the range; {} built now\n", versions.new_builds());
    return kExitOk;
  }
  const bool is_confirmed =
      find_change(versions, arguments, found.last_before, found.first_after).has_value();
  std::cout << fmt::format("{} by its runs and those of its parent; {} of {} used, {} built now\n",
                           is_confirmed ? "confirmed" : "not confirmed", versions.versions(),
                           counted(static_cast<std::size_t>(last + 1), "commit"), versions.new_builds());
  return is_confirmed ? kExitOk : kExitInconclusive;
}

int bisect(const BisectArguments& arguments) {
  install_interrupt_handlers();
  VersionComparer versions(arguments);
  return search(versions, arguments);
}

}  // namespace

Command bisect_command() {
  const auto arguments = std::make_shared<BisectArguments>();
  return {
      .name = "bisect",
      .summary =
          "Find the commit that changed a metric, by pairs of runs of builds of few commits; exit code 3 = "
          "undecided",
      .example = "bisect ate_rmse_m v1.0..HEAD --system my_slam.toml --plan quick",
      .options =
          {{"METRIC",
            "Id of a metric or of a timed module as in result.json; failed_runs: failures become more "
            "frequent",
            &arguments->metric},
           {"RANGE", "GOOD..BAD: commits of git, along first parents", &arguments->range},
           {"--system",
            "Description with the table [source] [this odometry; its repository is the current folder]",
            &arguments->system},
           {"--plan", "Sequences of the runs [quick]", &arguments->plan},
           {"--out", "Folder of the stores, one per compared pair of commits [build/bench/bisect]",
            &arguments->out},
           {"--builds", kBuildsHelp, &arguments->builds},
           {"--max-pairs", "Most pairs of runs per comparison [64]", &arguments->max_pairs, {2, 1000}}},
      .action = [arguments] { return bisect(*arguments); }};
}

}  // namespace stillpoint::bench
