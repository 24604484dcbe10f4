// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/stats_faults.h"

#include <algorithm>
#include <iostream>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/model/metrics.h"
#include "bench/plan/bench_plan.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr double kMaxErrorRatio = 3.0;
constexpr double kMinError_m = 0.02;
constexpr double kMaxFalseConfidence = 0.005;

/// What became of a run, and whether that was expected.
struct FaultOutcome {
  std::string text;
  bool as_expected = false;
};

/// What became of the runs of one variant.
struct FaultTally {
  int runs = 0;
  int as_expected = 0;
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
  tally.false_confidence += metric_value(*run, metric_id::kFalseConfidence).value_or(0.0);
  tally.missed_availability += metric_value(*run, metric_id::kMissedAvailability).value_or(0.0);
  return outcome.text + (outcome.as_expected ? "" : " (!)");
}

std::string tally_text(const std::string& variant, const FaultTally& tally) {
  const double runs = std::max(1, tally.runs);
  return fmt::format(
      "{}: {} of {} runs as expected; {:.2f} % false confidence, {:.2f} % missed availability.", variant,
      tally.as_expected, tally.runs, 100.0 * tally.false_confidence / runs,
      100.0 * tally.missed_availability / runs);
}

}  // namespace

int stats_faults(const StatsArguments& arguments) {
  StatsArguments chosen = arguments;
  if (chosen.plan.empty()) chosen.plan = "faults";
  const BenchPlan plan = load_plan(chosen.plan);
  if (plan.expected.empty()) throw InputError(plan.path, "has no key \"expected\"");
  const Store store(chosen.store);
  const RunSelection selection = chosen_runs(store, chosen);
  std::vector<std::string> header = {"sequence", "fault", "expected"};
  header.insert(header.end(), plan.variants.begin(), plan.variants.end());
  std::vector<GroupRows> groups;
  std::vector<std::string> notes = {
      "Cells: outcome, error after recovery, false confidence; (!): not as expected. The expectation is that "
      "of the first variant."};
  bool all_expected = true;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}};
    std::vector<FaultTally> tallies(plan.variants.size());
    for (const std::string& sequence : plan.rendered.sequences) {
      for (std::size_t i = 0; i < plan.faults.size(); ++i) {
        if (plan.faults[i] == kNoFault) continue;
        rows.rows.push_back({sequence, plan.faults[i], plan.expected[i]});
        for (std::size_t v = 0; v < plan.variants.size(); ++v) {
          const RunIdentity identity{.variant = plan.variants[v],
                                     .sequence = sequence + " + " + plan.faults[i]};
          rows.rows.back().push_back(cell_of(group, identity, plan.expected[i], tallies[v]));
        }
      }
    }
    for (std::size_t v = 0; v < tallies.size(); ++v)
      notes.push_back(tally_text(plan.variants[v], tallies[v]));
    all_expected = all_expected && tallies.front().as_expected == tallies.front().runs;
    groups.push_back(std::move(rows));
  }
  print_groups(header, groups, notes, chosen);
  return all_expected ? kExitOk : kExitFindings;
}

}  // namespace stillpoint::bench
