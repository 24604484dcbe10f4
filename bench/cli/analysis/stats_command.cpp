// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats`: ablation, repeat, faults, imperfections, summary and sweep.
#include <algorithm>
#include <iostream>
#include <memory>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/analysis/run_statistics.h"
#include "bench/cli/analysis/fault_means.h"
#include "bench/cli/analysis/stats_table.h"
#include "bench/cli/command_line.h"
#include "bench/model/metrics.h"
#include "bench/plan/bench_plan.h"
#include "core/base/error.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

std::vector<std::string> variants_of(const std::vector<StoredRun>& runs) {
  std::vector<std::string> variants;
  for (const StoredRun& run : runs) {
    const std::string& variant = run.identity.variant;
    if (std::find(variants.begin(), variants.end(), variant) == variants.end()) variants.push_back(variant);
  }
  return variants;
}

/// Runs that may be pooled, and the bases of their variants.
struct Ablation {
  std::vector<StoredRun> runs;
  std::vector<AblationGroup> bases;
};

/// A plan that names a base, and its runs with any build.
struct BasedPlan {
  std::string base;
  std::set<std::int64_t> runs;  ///< ids
};

std::vector<BasedPlan> plans_with_base(const Store& store, const StatsArguments& arguments) {
  std::vector<BasedPlan> plans;
  for (const StoredPlan& plan : store.plans()) {
    const std::optional<std::string> base = ablation_base_of(plan);
    if (!base || (!arguments.plan.empty() && plan.name != arguments.plan)) continue;
    plans.push_back({.base = *base, .runs = {}});
    for (const StoredRun& run : runs_of_plan(store, plan.name)) plans.back().runs.insert(run.id);
  }
  return plans;
}

/// An ablation with the named base.
std::vector<Ablation> ablation_of_base(const RunGroup& group, const std::string& base) {
  std::vector<std::string> variants = variants_of(group.runs);
  if (std::erase(variants, base) == 0 || variants.empty()) return {};
  return {{group.runs, {{.base = base, .variants = variants}}}};
}

/// One ablation for each plan.
std::vector<Ablation> ablations_of_plans(const RunGroup& group, const std::vector<BasedPlan>& plans) {
  std::vector<Ablation> ablations;
  for (const BasedPlan& plan : plans) {
    std::vector<StoredRun> runs = group.runs;
    std::erase_if(runs, [&](const StoredRun& run) { return !plan.runs.contains(run.id); });
    std::vector<AblationGroup> bases = ablation_groups(plan.base, variants_of(runs));
    if (!bases.empty()) ablations.push_back({std::move(runs), std::move(bases)});
  }
  return ablations;
}

/// @param what "runs" or "pairs"
std::string copies_note(std::size_t copies, const char* what) {
  return fmt::format(
      "{} {} have the result of another seed or repetition to the bit: copies, which count once. Vary {} to "
      "obtain "
      "replicates of a deterministic run.",
      copies, what, kPerturbationKey);
}

std::string without_value_note(std::size_t count, const char* what) {
  return fmt::format("No finite value of the metric in {} {}; they are neither failed nor counted in n.",
                     count, what);
}

std::string change_text(const eval::RelativeChange& change) {
  const std::string interval =
      change.interval
          ? fmt::format("{:+.1f} to {:+.1f} %", 100.0 * change.interval->low, 100.0 * change.interval->high)
          : "no interval";
  return fmt::format("{:+.1f} % (n = {}, {})", 100.0 * change.median, change.count, interval);
}

std::vector<std::string> cells_of(const AblationRow& row, const std::string& base) {
  const std::size_t count = row.difference ? row.difference->count : 0;
  std::vector<std::string> cells = {base, row.variant, row.sequence.empty() ? "(all)" : row.sequence,
                                    fmt::format("{}", count), fmt::format("{}", row.newly_failed)};
  if (row.difference) {
    cells.insert(
        cells.end(),
        {number_cell(row.difference->median), interval_cell(row.difference->interval, count),
         fmt::format("{:+.2f}", row.difference->effect), row.change ? change_text(*row.change) : "n/a"});
  } else {
    cells.insert(cells.end(), 4, "n/a");
  }
  return cells;
}

/// The rows of one group, and n of each row.
struct AblationTable {
  report::TableRows rows;
  std::set<std::size_t> counts;
  std::size_t copies = 0;
  std::size_t without_value = 0;
};

AblationTable table_of(const std::vector<Ablation>& ablations, const std::string& metric) {
  AblationTable table;
  for (const Ablation& one : ablations) {
    for (const AblationGroup& group : one.bases) {
      for (const AblationRow& row : ablation(one.runs, group.base, metric)) {
        const auto& variants = group.variants;
        if (std::find(variants.begin(), variants.end(), row.variant) == variants.end()) continue;
        table.rows.push_back(cells_of(row, group.base));
        table.copies += row.sequence.empty() ? row.copies : 0;
        table.without_value += row.sequence.empty() ? row.newly_without_value : 0;
        table.counts.insert(row.difference ? row.difference->count : 0);
      }
    }
  }
  return table;
}

[[noreturn]] void reject_base(const RunSelection& selection, const StatsArguments& arguments) {
  std::vector<std::string> variants;
  for (const RunGroup& group : selection.groups) {
    for (const std::string& variant : variants_of(group.runs)) {
      if (std::find(variants.begin(), variants.end(), variant) == variants.end()) variants.push_back(variant);
    }
  }
  const bool is_known = std::find(variants.begin(), variants.end(), arguments.base) != variants.end();
  std::string problem = "is required: no plan of these runs has the key ablation_base";
  if (!arguments.base.empty())
    problem = is_known ? "no other variant was executed with the same build, machine and mode"
                       : "there is no run of variant \"" + arguments.base + "\"";
  throw InputError("--base", fmt::format("{}; existing variants: {}", problem, fmt::join(variants, ", ")));
}

/// Prints the paired differences of each variant from its base: `arguments.base`, or else the `ablation_base`
/// of each plan.
/// @return exit code
/// @throws InputError if neither is given; the message lists the variants
int stats_ablation(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  require_metric(selection, arguments.metric);
  std::vector<GroupRows> groups;
  std::set<std::size_t> counts;
  std::size_t copies = 0;
  std::size_t without_value = 0;
  const std::vector<BasedPlan> plans =
      arguments.base.empty() ? plans_with_base(store, arguments) : std::vector<BasedPlan>{};
  for (const RunGroup& group : selection.groups) {
    AblationTable table = table_of(
        arguments.base.empty() ? ablations_of_plans(group, plans) : ablation_of_base(group, arguments.base),
        arguments.metric);
    counts.merge(table.counts);
    copies += table.copies;
    without_value += table.without_value;
    if (!table.rows.empty()) groups.push_back({.group = &group, .rows = std::move(table.rows)});
  }
  if (groups.empty()) reject_base(selection, arguments);
  std::vector<std::string> notes = {
      fmt::format(
          "{}; paired by sequence and seed, repetitions reduced to their median; n: pairs, of (all) with "
          "several sequences: sequences; difference and change: Hodges-Lehmann estimates; effect: "
          "matched-pairs rank-biserial correlation, 1 = all "
          "pairs increased.",
          arguments.metric),
      interval_note("exact Wilcoxon signed-rank test", counts)};
  if (copies > 0) notes.push_back(copies_note(copies, "pairs"));
  if (without_value > 0) notes.push_back(without_value_note(without_value, "pairs: only the base has one"));
  notes.insert(notes.end(), selection.left_out.begin(), selection.left_out.end());
  print_groups(
      {"base", "variant", "sequence", "n", "newly failed", "difference", "95 % interval", "effect", "change"},
      groups, notes, arguments);
  return kExitOk;
}

int compare_repetitions(const Store& store, const RunSelection& selection, const StatsArguments& arguments) {
  std::vector<GroupRows> groups;
  bool all_equal = true;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}};
    for (const RepetitionRow& row : repetition_report(store, group.runs)) {
      all_equal = all_equal && row.is_repeatable();
      const std::string unknown = row.distinct_trajectories == 1 ? "none" : "not recorded";
      rows.rows.push_back({row.label, fmt::format("{}", row.repetitions), fmt::format("{}", row.failed),
                           fmt::format("{}", row.distinct_trajectories),
                           row.first_difference.empty() ? unknown : row.first_difference});
    }
    if (!rows.rows.empty()) groups.push_back(std::move(rows));
  }
  if (groups.empty())
    throw InputError(arguments.store, "contains no repeated run; set `repetitions = 2` in a plan");
  print_groups(
      {"run", "repetitions", "failed", "trajectories", "first difference"}, groups,
      with_left_out({all_equal ? "All repetitions are bit-equal: a single run is sufficient."
                               : "Some repetitions differ or failed: evaluate failures and the spread "
                                 "over repetitions."},
                    selection),
      arguments);
  return all_equal ? kExitOk : kExitFindings;
}

std::string ate_cell(const std::optional<double>& ate) { return ate ? number_cell(*ate) : "n/a"; }

std::vector<std::string> difference_cells(const ExecutionDifference& row) {
  if (!row.failure.empty()) return {row.label, "n/a", row.failure, "n/a", "n/a", "n/a", "n/a"};
  std::string stages;
  for (const StageDifference& stage : row.stages) {
    stages += fmt::format("{}{} {}", stages.empty() ? "" : ", ", stage.stage,
                          stage.frame ? fmt::format("{}", *stage.frame) : "-");
  }
  return {row.label,
          fmt::format("{}", row.frames),
          stages.empty() ? "not recorded" : stages,
          row.equal_trajectories ? "equal" : fmt::format("{:.2g} m", row.largest_m),
          row.equal_trajectories ? "equal"
                                 : fmt::format("{:.2g} deg", row.largest_rad * 180.0 / std::numbers::pi),
          ate_cell(row.ate_m),
          ate_cell(row.other_ate_m)};
}

int compare_stores(const Store& store, const RunSelection& selection, const StatsArguments& arguments) {
  const Store other(arguments.other);
  std::vector<GroupRows> groups;
  bool all_equal = true;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}};
    for (const ExecutionDifference& row : execution_differences(store, group.runs, other)) {
      all_equal = all_equal && row.equal_trajectories;
      rows.rows.push_back(difference_cells(row));
    }
    if (!rows.rows.empty()) groups.push_back(std::move(rows));
  }
  if (groups.empty()) {
    throw InputError(arguments.other, "contains no run that " + arguments.store +
                                          " contains, too: execute the same plan by the same build on both");
  }
  print_groups({"run", "frames", "first frame that differs", "largest distance", "largest angle", "ATE m",
                "ATE m, other"},
               groups,
               with_left_out(
                   {fmt::format("First frame that differs, by stage; -: none. Other: {}. {}", arguments.other,
                                all_equal ? "All trajectories are equal to nine decimals."
                                          : "Some trajectories differ.")},
                   selection),
               arguments);
  return all_equal ? kExitOk : kExitFindings;
}

/// Prints for each repeated run whether its repetitions are bit-equal, else the first frame and stage that
/// differ. With another store (`StatsArguments::other`): for each run that both contain, the first frame in
/// which each stage differs, the largest distance of the poses, and both ATE.
/// @return exit code: findings if a run differs
/// @throws InputError if there is nothing to compare
int stats_repeat(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  return arguments.other.empty() ? compare_repetitions(store, selection, arguments)
                                 : compare_stores(store, selection, arguments);
}

constexpr double kMaxErrorRatio = 3.0;
constexpr double kMinError_m = 0.02;
constexpr double kMaxFalseConfidence = 0.005;
constexpr double kMaxTimeToDetect_s = 0.5;

/// What became of a run, and whether that was expected.
struct FaultOutcome {
  std::string text;
  bool as_expected = false;
};

/// What became of the runs of one variant.
struct FaultTally {
  int runs = 0;
  int as_expected = 0;
  int late = 0;                      ///< runs in which a wrong pose was called located for too long
  double false_confidence = 0.0;     ///< sum over runs of the same length
  double missed_availability = 0.0;  ///< same
};

const StoredRun* find_run(const RunGroup& group, const std::string& variant, const std::string& sequence) {
  const auto found = std::ranges::find_if(group.runs, [&](const StoredRun& run) {
    return run.identity.variant == variant && run.identity.sequence == sequence;
  });
  return found == group.runs.end() ? nullptr : &*found;
}

FaultOutcome outcome_of(const StoredRun& run, double max_error_m, const std::string& expected) {
  if (run.outcome != Outcome::kOk) return {outcome_name(run.outcome), false};
  const std::optional<double> wrong = metric_value(run, metric_id::kFalseConfidence);
  const std::optional<double> error_m = metric_value(run, metric_id::kErrorAfterRecovery);
  if (!wrong) return {"n/a", false};
  const bool honest = *wrong <= kMaxFalseConfidence;
  const bool survived = honest && error_m && *error_m <= max_error_m;
  const std::string outcome = survived ? "survive" : honest ? "lose" : "wrong";
  const std::string error = error_m ? fmt::format("{:.3f} m", *error_m) : "-";
  return {fmt::format("{}, {}, {:.1f} %", outcome, error, 100.0 * *wrong),
          outcome == expected || (survived && expected == kExpectLoss)};
}

/// The cell of a run; counts it.
std::string cell_of(const RunGroup& group, const RunIdentity& identity, const std::string& expected,
                    FaultTally& tally) {
  const StoredRun* run = find_run(group, identity.variant, identity.sequence);
  if (run == nullptr) return "not run";
  const StoredRun* undisturbed =
      find_run(group, identity.variant, identity.sequence.substr(0, identity.sequence.find(" + ")));
  const double ate = undisturbed == nullptr ? 0.0 : metric_value(*undisturbed, metric_id::kAte).value_or(0.0);
  const FaultOutcome outcome = outcome_of(*run, std::max(kMinError_m, kMaxErrorRatio * ate), expected);
  ++tally.runs;
  tally.as_expected += outcome.as_expected;
  tally.late += metric_value(*run, metric_id::kTimeToDetect).value_or(0.0) > kMaxTimeToDetect_s;
  tally.false_confidence += metric_value(*run, metric_id::kFalseConfidence).value_or(0.0);
  tally.missed_availability += metric_value(*run, metric_id::kMissedAvailability).value_or(0.0);
  return outcome.text + (outcome.as_expected ? "" : " (!)");
}

/// Median over the undisturbed sequences of the plan.
std::string claim_text(const RunGroup& group, const std::string& variant, const BenchPlan& plan) {
  std::vector<double> claims;
  for (const std::string& sequence : plan.rendered.sequences) {
    const StoredRun* run = find_run(group, variant, sequence);
    const auto claim = run == nullptr ? std::nullopt : metric_value(*run, metric_id::kClaimedThreeSigma);
    if (claim) claims.push_back(*claim);
  }
  const std::optional<double> median = eval::percentile(claims, 0.5);
  return median ? fmt::format("{:.3f} m", *median) : "-";
}

/// Matrix and totals of one group of runs.
class FaultMatrix {
 public:
  FaultMatrix(const BenchPlan& plan, const RunGroup& group)
      : plan_(plan), group_(group), variants_(compared_names(plan)), tallies_(variants_.size()) {
    for (const std::string& sequence : plan.rendered.sequences) {
      for (std::size_t i = 0; i < plan.faults.size(); ++i) {
        if (plan.faults[i] != kNoFault) add_row(sequence, plan.faults[i], plan.expected[i]);
      }
    }
  }

  [[nodiscard]] GroupRows rows() const { return {.group = &group_, .rows = rows_}; }

  /// One row per variant.
  [[nodiscard]] report::TableRows totals() const {
    report::TableRows rows = {{"variant", "runs", "as expected", "false confidence", "missed availability",
                               "detected after 0.5 s", "3 sigma, undisturbed"}};
    for (std::size_t v = 0; v < tallies_.size(); ++v) {
      const FaultTally& tally = tallies_[v];
      if (tally.runs == 0) continue;  // of another group
      const double runs = std::max(1, tally.runs);
      rows.push_back({variants_[v], fmt::format("{}", tally.runs),
                      fmt::format("{} ({:.0f} %)", tally.as_expected, 100.0 * tally.as_expected / runs),
                      fmt::format("{:.2f} %", 100.0 * tally.false_confidence / runs),
                      fmt::format("{:.2f} %", 100.0 * tally.missed_availability / runs),
                      fmt::format("{}", tally.late), claim_text(group_, variants_[v], plan_)});
    }
    return rows;
  }

  /// Whether all runs of the first variant did as expected.
  [[nodiscard]] bool is_as_expected() const { return tallies_.front().as_expected == tallies_.front().runs; }

 private:
  void add_row(const std::string& sequence, const std::string& fault, const std::string& expected) {
    rows_.push_back({sequence, fault, expected});
    for (std::size_t v = 0; v < variants_.size(); ++v) {
      const RunIdentity identity{.variant = variants_[v],
                                 .sequence = fmt::format("{} + {}", sequence, fault)};
      rows_.back().push_back(cell_of(group_, identity, expected, tallies_[v]));
    }
  }

  const BenchPlan& plan_;
  const RunGroup& group_;
  std::vector<std::string> variants_;
  std::vector<FaultTally> tallies_;  ///< per variant
  report::TableRows rows_;
};

/// Prints a matrix of the faults of a plan and the variants: whether each run did as the plan expects, its
/// error after recovery and its false confidence; below it one row of totals per variant: false confidence
/// and missed availability of all frames, runs in which a wrong pose was called located for more than 0.5 s,
/// and the claimed standard deviation of undisturbed runs.
///
/// A run survived if it recovered in the same world with an error of at most three times the ATE of the
/// undisturbed run, or 2 cm, and a false confidence of at most 0.5 %. Else it lost honestly if its false
/// confidence is that small, and is wrong if not.
/// @return exit code: findings if a run of the first variant did not do as expected
int stats_faults(const StatsArguments& arguments) {
  StatsArguments chosen = arguments;
  if (chosen.plan.empty()) chosen.plan = "faults";
  const BenchPlan plan = load_plan(chosen.plan);
  chosen.plan = plan.name;  // runs are stored under it, also those of a plan file
  if (plan.expected.empty()) throw InputError(plan.path, "has no key \"expected\"");
  const Store store(chosen.store);
  const RunSelection selection = chosen_runs(store, chosen);
  std::vector<std::string> header = {"sequence", "fault", "expected"};
  const std::vector<std::string> variants = compared_names(plan);
  header.insert(header.end(), variants.begin(), variants.end());
  std::vector<GroupRows> groups;
  report::TableRows totals;
  bool all_expected = true;
  for (const RunGroup& group : selection.groups) {
    const FaultMatrix matrix(plan, group);
    groups.push_back(matrix.rows());
    const report::TableRows rows = matrix.totals();
    totals.insert(totals.end(), rows.begin() + (totals.empty() ? 0 : 1), rows.end());
    all_expected = all_expected && matrix.is_as_expected();
  }
  print_groups(
      header, groups,
      {"Cells: outcome, error after recovery, false confidence; (!): not as expected. The expectation "
       "is that of the first variant."},
      chosen);
  std::ostream& remarks = chosen.csv ? std::cerr : std::cout;
  remarks << '\n' << report::format_table(totals, report::TableStyle::kMarkdown);
  return all_expected ? kExitOk : kExitFindings;
}

constexpr const char* kMedianTest = "exact, by order statistics";

std::size_t count_of(const RunSpread& row) { return row.spread ? row.spread->count : 0; }

std::vector<std::string> summary_cells(const RunSpread& row) {
  const std::size_t count = count_of(row);
  std::vector<std::string> cells = {row.sequence,
                                    row.variant,
                                    row.axis.empty() ? "" : fmt::format("{} = {}", row.axis, row.axis_value),
                                    fmt::format("{}", row.runs),
                                    fmt::format("{}", row.failed),
                                    fmt::format("{}", count)};
  if (row.spread) {
    cells.insert(cells.end(),
                 {number_cell(row.spread->median), interval_cell(row.spread->median_interval, count),
                  interval_cell(row.spread->quartiles, count), number_cell(row.spread->worst),
                  row.spread->modes ? fmt::format("{}", *row.spread->modes) : "n/a"});
  } else {
    cells.insert(cells.end(), 5, "n/a");
  }
  return cells;
}

/// Rows of the spreads of one metric, and the numbers of replicates behind them.
struct SpreadRows {
  std::vector<GroupRows> groups;
  std::set<std::size_t> counts;
  std::size_t copies = 0;
  std::size_t without_value = 0;
  std::vector<std::string> doubts;
};

/// One row for each spread that satisfies `keep`; a group without a row is left out.
SpreadRows spread_rows(const RunSelection& selection, const std::string& metric,
                       bool (*keep)(const RunSpread&), std::vector<std::string> (*cells)(const RunSpread&)) {
  require_metric(selection, metric);
  SpreadRows result;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}};
    for (const RunSpread& row : run_spreads(group.runs, metric)) {
      if (!keep(row)) continue;
      result.counts.insert(count_of(row));
      result.copies += row.copies;
      result.without_value += row.without_value;
      if (!row.doubt.empty())
        result.doubts.push_back(fmt::format("{}, {}: {}.", row.sequence, row.variant, row.doubt));
      rows.rows.push_back(cells(row));
    }
    if (!rows.rows.empty()) result.groups.push_back(std::move(rows));
  }
  return result;
}

int summary(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  const SpreadRows rows = spread_rows(
      selection, arguments.metric, [](const RunSpread&) { return true; }, summary_cells);
  std::vector<std::string> notes = {arguments.metric + "; n: different results with a value.",
                                    interval_note(kMedianTest, rows.counts)};
  if (rows.copies > 0) notes.push_back(copies_note(rows.copies, "runs"));
  if (rows.without_value > 0) notes.push_back(without_value_note(rows.without_value, "succeeded runs"));
  print_groups({"sequence", "variant", "sweep", "runs", "failed", "n", "median", "median 95 %", "quartiles",
                "worst", "modes"},
               rows.groups, with_left_out(with_doubts(std::move(notes), rows.doubts), selection), arguments);
  return kExitOk;
}

std::vector<std::string> sweep_cells(const RunSpread& row) {
  const auto cell = [](const std::optional<double>& value) { return value ? number_cell(*value) : "n/a"; };
  const eval::Spread spread = row.spread.value_or(eval::Spread{});
  const std::optional<eval::Interval>& interval = spread.median_interval;
  return {row.axis,
          fmt::format("{}", row.axis_value),
          row.sequence,
          row.variant,
          fmt::format("{}", row.runs),
          fmt::format("{}", row.failed),
          fmt::format("{}", spread.count),
          cell(row.spread ? std::optional(spread.median) : std::nullopt),
          cell(interval ? std::optional(interval->low) : std::nullopt),
          cell(interval ? std::optional(interval->high) : std::nullopt)};
}

int sweep(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  const SpreadRows rows = spread_rows(
      selection, arguments.metric, [](const RunSpread& row) { return !row.axis.empty(); }, sweep_cells);
  if (rows.groups.empty())
    throw InputError(arguments.store, "contains no run of a sweep; add a [sweep] to a plan");
  print_groups(
      {"axis", "value", "sequence", "variant", "runs", "failed", "n", "median", "median 95 % low", "high"},
      rows.groups,
      with_left_out(
          with_doubts({arguments.metric + ".", interval_note(kMedianTest, rows.counts)}, rows.doubts),
          selection),
      arguments);
  return kExitOk;
}

/// Adds the action and the options that all subcommands have.
Command subcommand(Command command, const std::shared_ptr<StatsArguments>& arguments,
                   int (*action)(const StatsArguments&)) {
  command.options.insert(command.options.begin(),
                         {store_option(&arguments->store),
                          {"--plan", "Only the runs of this plan", &arguments->plan},
                          {"--build", "Build, a prefix of one, or \"all\" [the newest]", &arguments->build},
                          {"--csv", "CSV instead of Markdown", &arguments->csv}});
  command.action = [arguments, action] { return action(*arguments); };
  return command;
}

}  // namespace

Command stats_command() {
  const auto arguments = std::make_shared<StatsArguments>();
  arguments->metric = headline_metric().id;
  const Option metric{"--metric", "Metric to evaluate [" + arguments->metric + "]", &arguments->metric};
  const Option base{"--base", "Variant that the others are compared with [ablation_base of the plan]",
                    &arguments->base};
  std::vector<Command> subcommands = {
      subcommand({.name = "summary",
                  .summary = "Median with confidence interval, quartiles, worst value and failures "
                             "of each variant on each sequence",
                  .example = "stats summary --plan quick --metric " + arguments->metric,
                  .options = {metric}},
                 arguments, summary),
      subcommand({.name = "ablation",
                  .summary = "Paired differences from a base variant, with confidence interval and "
                             "effect size",
                  .example = "stats ablation --plan table2_ablation_synthetic",
                  .options = {metric, base}},
                 arguments, stats_ablation),
      subcommand({.name = "faults",
                  .summary = "Matrix of sensor faults and variants: outcome, error after recovery and "
                             "false confidence",
                  .example = "stats faults --plan faults"},
                 arguments, stats_faults),
      subcommand({.name = "imperfections",
                  .summary = "Geometric means of the ATE over sequences with injected faults, lost runs "
                             "and false confidence",
                  .example = "stats imperfections --plan imperfections"},
                 arguments, stats_imperfections),
      subcommand({.name = "repeat",
                  .summary = "Check that repetitions, or runs of two machines, are bit-equal",
                  .example = "stats repeat build/bench/store.sqlite",
                  .options = {{"--with", "Store of another machine: compare the runs that both contain",
                               &arguments->other}}},
                 arguments, stats_repeat),
      subcommand({.name = "sweep",
                  .summary = "Degradation curves: one row per value, sequence and variant",
                  .example = "stats sweep --plan sweep_synthetic --csv",
                  .options = {metric}},
                 arguments, sweep)};
  return {.name = "stats",
          .summary = "Statistics over the runs of a store; without a subcommand: summary",
          .example = "stats build/bench/store.sqlite",
          .options = subcommands.front().options,
          .action = subcommands.front().action,
          .subcommands = std::move(subcommands)};
}

}  // namespace stillpoint::bench
