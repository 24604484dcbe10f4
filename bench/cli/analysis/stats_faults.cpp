// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/stats_faults.h"

#include <algorithm>
#include <iostream>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/model/metrics.h"
#include "bench/plan/bench_plan.h"
#include "core/base/error.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

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
      : plan_(plan), group_(group), tallies_(plan.variants.size()) {
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
      const double runs = std::max(1, tally.runs);
      rows.push_back({plan_.variants[v], fmt::format("{}", tally.runs),
                      fmt::format("{} ({:.0f} %)", tally.as_expected, 100.0 * tally.as_expected / runs),
                      fmt::format("{:.2f} %", 100.0 * tally.false_confidence / runs),
                      fmt::format("{:.2f} %", 100.0 * tally.missed_availability / runs),
                      fmt::format("{}", tally.late), claim_text(group_, plan_.variants[v], plan_)});
    }
    return rows;
  }

  /// Whether all runs of the first variant did as expected.
  [[nodiscard]] bool is_as_expected() const { return tallies_.front().as_expected == tallies_.front().runs; }

 private:
  void add_row(const std::string& sequence, const std::string& fault, const std::string& expected) {
    rows_.push_back({sequence, fault, expected});
    for (std::size_t v = 0; v < plan_.variants.size(); ++v) {
      const RunIdentity identity{.variant = plan_.variants[v], .sequence = sequence + " + " + fault};
      rows_.back().push_back(cell_of(group_, identity, expected, tallies_[v]));
    }
  }

  const BenchPlan& plan_;
  const RunGroup& group_;
  std::vector<FaultTally> tallies_;  ///< per variant
  report::TableRows rows_;
};

}  // namespace

int stats_faults(const StatsArguments& arguments) {
  StatsArguments chosen = arguments;
  if (chosen.plan.empty()) chosen.plan = "faults";
  const BenchPlan plan = load_plan(chosen.plan);
  chosen.plan = plan.name;  // runs are stored under it, also those of a plan file
  if (plan.expected.empty()) throw InputError(plan.path, "has no key \"expected\"");
  const Store store(chosen.store);
  const RunSelection selection = chosen_runs(store, chosen);
  std::vector<std::string> header = {"sequence", "fault", "expected"};
  header.insert(header.end(), plan.variants.begin(), plan.variants.end());
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

}  // namespace stillpoint::bench
