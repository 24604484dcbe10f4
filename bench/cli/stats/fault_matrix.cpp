// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats faults`.
#include <algorithm>
#include <iostream>
#include <set>
#include <span>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/stats/stats_actions.h"
#include "bench/config/toml_source.h"
#include "bench/model/metrics.h"
#include "bench/plan/bench_plan.h"
#include "bench/plan/plan_sequences.h"
#include "bench/systems/external_system.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

constexpr double kMaxErrorRatio = 3.0;
constexpr double kMinError_m = 0.02;
constexpr double kMaxFalseConfidence = 0.005;
constexpr double kMaxTimeToDetect_s = 0.5;

/// The variants of a plan, and the names of its external systems.
/// @throws InputError if a description cannot be read
std::vector<std::string> compared_names(const BenchPlan& plan) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const auto* variants : {&plan.variants, &plan.rendered.variants, &plan.recorded.variants})
    std::ranges::for_each(*variants, add);
  for (const std::string& system : plan.systems) add(load_external_system(system).variant);
  return names;
}

/// What became of a run, and whether that was expected.
struct FaultOutcome {
  std::string text;
  std::string result{};  ///< survive, lose or wrong; empty without a score
  bool as_expected = false;
};

/// What became of the runs of one variant.
struct FaultTally {
  int runs = 0;
  int as_expected = 0;
  int late = 0;                      ///< runs in which a wrong pose was called located for too long
  int scored = 0;                    ///< runs whose frames were scored: not those that crashed
  double false_confidence = 0.0;     ///< sum over the scored runs, which have the same length
  double missed_availability = 0.0;  ///< same
};

const StoredRun* find_run(const RunGroup& group, const std::string& variant, const std::string& sequence) {
  const auto found = std::ranges::find_if(group.runs, [&](const StoredRun& run) {
    return run.identity.variant == variant && run.identity.sequence == sequence;
  });
  return found == group.runs.end() ? nullptr : &*found;
}

/// Of one variant on one sequence.
std::size_t count_runs(const RunGroup& group, const RunIdentity& identity) {
  return static_cast<std::size_t>(std::ranges::count_if(group.runs, [&](const StoredRun& run) {
    return run.identity.variant == identity.variant && run.identity.sequence == identity.sequence;
  }));
}

FaultOutcome outcome_of(const StoredRun& run, double max_error_m, const std::string& expected) {
  if (run.outcome != Outcome::kOk) return {.text = outcome_name(run.outcome)};
  const std::optional<double> wrong = metric_value(run, metric_id::kFalseConfidence);
  const std::optional<double> error_m = metric_value(run, metric_id::kErrorAfterRecovery);
  if (!wrong) return {.text = "n/a"};
  const bool honest = *wrong <= kMaxFalseConfidence;
  const bool survived = honest && error_m && *error_m <= max_error_m;
  const std::string outcome = survived ? "survive" : honest ? "lose" : "wrong";
  const std::string error = error_m ? fmt::format("{:.3f} m", *error_m) : "-";
  return {fmt::format("{}, {}, {:.1f} %", outcome, error, 100.0 * *wrong), outcome,
          outcome == expected || (survived && expected == kExpectLoss)};
}

/// A run of the matrix; null if it was not executed.
struct MatrixRun {
  const StoredRun* run = nullptr;
  FaultOutcome outcome{};
};

/// The run of a variant on a sequence with a fault.
MatrixRun matrix_run(const RunGroup& group, const RunIdentity& identity, const std::string& expected) {
  const StoredRun* run = find_run(group, identity.variant, identity.sequence);
  if (run == nullptr) return {};
  const StoredRun* undisturbed =
      find_run(group, identity.variant, identity.sequence.substr(0, identity.sequence.find(kFaultSeparator)));
  const double ate = undisturbed == nullptr ? 0.0 : metric_value(*undisturbed, metric_id::kAte).value_or(0.0);
  return {run, outcome_of(*run, std::max(kMinError_m, kMaxErrorRatio * ate), expected)};
}

void count(const MatrixRun& one, FaultTally& tally) {
  ++tally.runs;
  tally.as_expected += one.outcome.as_expected;
  tally.late += metric_value(*one.run, metric_id::kTimeToDetect).value_or(0.0) > kMaxTimeToDetect_s;
  const std::optional<double> wrong = metric_value(*one.run, metric_id::kFalseConfidence);
  if (!wrong) return;
  ++tally.scored;
  tally.false_confidence += *wrong;
  tally.missed_availability += metric_value(*one.run, metric_id::kMissedAvailability).value_or(0.0);
}

std::string cell_of(const MatrixRun& one) {
  if (one.run == nullptr) return "not run";
  return one.outcome.text + (one.outcome.as_expected ? "" : " (!)");
}

std::vector<std::string> fault_columns() {
  return {"sequence",         "fault",
          "expected",         "variant",
          "outcome",          "result",
          "as_expected",      "error_after_recovery_m",
          "false_confidence", "missed_availability",
          "time_to_detect_s", "claimed_three_sigma_m"};
}

/// Outcome and scores of a run: the values from the fifth of `fault_columns` on.
report::DataRow score_values(const MatrixRun& one, bool is_disturbed) {
  if (one.run == nullptr) {
    report::DataRow values = {"not run"};
    values.resize(fault_columns().size() - 4);
    return values;
  }
  report::DataRow values = {outcome_name(one.run->outcome), report::data_value(one.outcome.result),
                            is_disturbed ? report::DataValue(one.outcome.as_expected) : report::DataValue()};
  for (const std::string_view metric :
       {metric_id::kErrorAfterRecovery, metric_id::kFalseConfidence, metric_id::kMissedAvailability,
        metric_id::kTimeToDetect, metric_id::kClaimedThreeSigma})
    values.push_back(report::data_value(metric_value(*one.run, metric)));
  return values;
}

/// The rendered sequences of the plan, executed or not, and the recorded ones that have runs, by name.
std::vector<std::string> sequences_of(const BenchPlan& plan, const RunGroup& group) {
  std::vector<std::string> names = matching_presets(plan.rendered.sequences);
  std::set<std::string> recorded;
  for (const StoredRun& run : group.runs) {
    const std::string& name = run.identity.sequence;
    recorded.insert(name.substr(0, name.find(kFaultSeparator)));
  }
  for (const std::string& name : names) recorded.erase(name);
  names.insert(names.end(), recorded.begin(), recorded.end());
  return names;
}

/// Median over the undisturbed sequences.
std::string claim_text(const RunGroup& group, const std::string& variant,
                       std::span<const std::string> sequences) {
  std::vector<double> claims;
  for (const std::string& sequence : sequences) {
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
      : group_(group),
        sequences_(sequences_of(plan, group)),
        variants_(compared_names(plan)),
        tallies_(variants_.size()) {
    for (const std::string& sequence : sequences_) {
      for (std::size_t i = 0; i < plan.faults.size(); ++i) {
        if (plan.faults[i] == kNoFault) {
          add_undisturbed(sequence);
        } else {
          add_row(sequence, plan.faults[i], plan.expected[i]);
        }
      }
    }
  }

  [[nodiscard]] GroupRows rows() const { return {.group = &group_, .rows = rows_, .data = data_}; }

  /// One row per variant.
  [[nodiscard]] report::TableRows totals() const {
    report::TableRows rows = {{"variant", "runs", "as expected", "false confidence", "missed availability",
                               "detected after 0.5 s", "3 sigma, undisturbed"}};
    for (std::size_t v = 0; v < tallies_.size(); ++v) {
      const FaultTally& tally = tallies_[v];
      if (tally.runs == 0) continue;  // of another group
      const auto mean_text = [&](double sum) {
        return tally.scored > 0 ? fmt::format("{:.2f} %", 100.0 * sum / tally.scored) : std::string("n/a");
      };
      rows.push_back({variants_[v], fmt::format("{}", tally.runs),
                      fmt::format("{} ({:.0f} %)", tally.as_expected, 100.0 * tally.as_expected / tally.runs),
                      mean_text(tally.false_confidence), mean_text(tally.missed_availability),
                      fmt::format("{}", tally.late), claim_text(group_, variants_[v], sequences_)});
    }
    return rows;
  }

  /// Whether a run has a fault of the plan.
  [[nodiscard]] bool has_runs() const {
    return std::ranges::any_of(tallies_, [](const FaultTally& tally) { return tally.runs > 0; });
  }

  /// Runs of other seeds and repetitions than those of the cells.
  [[nodiscard]] std::size_t left_out() const { return left_out_; }

  /// Whether all runs of the first variant did as expected.
  [[nodiscard]] bool is_as_expected() const { return tallies_.front().as_expected == tallies_.front().runs; }

 private:
  void add_row(const std::string& sequence, const std::string& fault, const std::string& expected) {
    rows_.push_back({sequence, fault, expected});
    for (std::size_t v = 0; v < variants_.size(); ++v) {
      const MatrixRun one = matrix_run(
          group_,
          {.variant = variants_[v], .sequence = fmt::format("{}{}{}", sequence, kFaultSeparator, fault)},
          expected);
      if (one.run != nullptr) {
        count(one, tallies_[v]);
        left_out_ += count_runs(group_, one.run->identity) - 1;
      }
      rows_.back().push_back(cell_of(one));
      add_data({sequence, fault, expected, variants_[v]}, score_values(one, true));
    }
  }

  /// For programs only.
  void add_undisturbed(const std::string& sequence) {
    for (const std::string& variant : variants_) {
      const MatrixRun one{.run = find_run(group_, variant, sequence)};
      add_data({sequence, std::string(kNoFault), {}, variant}, score_values(one, false));
    }
  }

  void add_data(report::DataRow names, const report::DataRow& values) {
    names.insert(names.end(), values.begin(), values.end());
    data_.push_back(std::move(names));
  }

  const RunGroup& group_;
  std::vector<std::string> sequences_;
  std::vector<std::string> variants_;
  std::vector<FaultTally> tallies_;  ///< per variant
  report::TableRows rows_;
  std::vector<report::DataRow> data_;
  std::size_t left_out_ = 0;
};

/// @throws InputError also if only the store has the plan, or it expects nothing
BenchPlan plan_of_faults(const Store& store, const std::string& name) {
  const bool is_stored =
      std::ranges::any_of(store.plans(), [&](const auto& plan) { return plan.name == name; });
  const std::vector<std::string> embedded = embedded_names(TomlKind::kPlan);
  if (is_stored && std::ranges::find(embedded, name) == embedded.end())
    throw InputError("--plan", "requires the file of the plan \"" + name + "\", e.g. " + name + ".toml");
  BenchPlan plan = load_plan(name);
  if (plan.expected.empty())
    throw InputError(plan.path,
                     "has no key \"expected\"; add it with \"survive\" or \"lose\" for each of \"faults\"");
  return plan;
}

}  // namespace

int stats_faults(const StatsArguments& arguments) {
  const Store store(arguments.store);
  StatsArguments chosen = with_default_plan(store, arguments, "faults");
  const BenchPlan plan = plan_of_faults(store, chosen.plan);
  chosen.plan = plan.name;  // runs are stored under it, also those of a plan file
  const RunSelection selection = chosen_runs(store, chosen);
  StatsTable output{.header = {"sequence", "fault", "expected"},
                    .kind = "stats_faults",
                    .columns = fault_columns(),
                    .groups = {},
                    .notes = {"Cells: outcome, error after recovery, false confidence; (!): not as expected. "
                              "The expectation is that of the first variant."}};
  const std::vector<std::string> variants = compared_names(plan);
  if (variants.empty()) throw InputError(plan.path, "has no variants and no systems");
  output.header.insert(output.header.end(), variants.begin(), variants.end());
  report::TableRows totals;
  bool all_expected = true;
  bool has_runs = false;
  std::size_t left_out = 0;
  for (const RunGroup& group : selection.groups) {
    const FaultMatrix matrix(plan, group);
    output.groups.push_back(matrix.rows());
    const report::TableRows rows = matrix.totals();
    totals.insert(totals.end(), rows.begin() + (totals.empty() ? 0 : 1), rows.end());
    all_expected = all_expected && matrix.is_as_expected();
    has_runs = has_runs || matrix.has_runs();
    left_out += matrix.left_out();
  }
  if (!has_runs)
    throw InputError(chosen.store, "contains no run with a fault of " + plan.path +
                                       "; execute them with `stillpoint bench`");
  if (chosen.format != StatsFormat::kTable)
    output.notes = {"The expectation is that of the first variant; runs without a fault have none."};
  if (left_out > 0)
    output.notes.push_back(
        fmt::format("Left out: {} of other seeds or repetitions. Each cell is the first of its runs, "
                    "totals and exit status are those of the cells.",
                    counted(left_out, "run")));
  print_stats(output, chosen);
  if (chosen.format == StatsFormat::kTable)
    std::cout << '\n' << report::format_table(totals, report::TableStyle::kMarkdown);
  return all_expected ? kExitOk : kExitFindings;
}

}  // namespace stillpoint::bench
