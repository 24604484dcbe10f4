// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats repeat`.
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/analysis/paired_runs.h"
#include "bench/cli/command_line.h"
#include "bench/cli/stats/stats_actions.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

report::DataRow identity_values(const RunIdentity& identity) {
  return {identity.sequence, identity.variant, identity.seed};
}

report::DataRow joined_values(report::DataRow values, const report::DataRow& more) {
  values.insert(values.end(), more.begin(), more.end());
  return values;
}

/// Whether all repetitions are equal, and by system the number of those that confirm a run and need not by
/// design.
struct RepetitionSummary {
  bool all_equal = true;
  std::map<std::string, std::size_t> confirming{};
};

std::string system_and_mode(const RunIdentity& identity) {
  return identity.mode.ends_with("realtime") ? identity.system + " in real time" : identity.system;
}

/// Where repetitions need not be equal by design, n of them without a difference exclude, with a confidence
/// of 95 %, that more than 1 - 0.05^(1/n) of the runs of that system differ.
std::string repetition_note(const RepetitionSummary& summary) {
  if (!summary.all_equal)
    return "Some repetitions differ or failed: evaluate failures and the spread over repetitions.";
  if (summary.confirming.empty()) return "All repetitions are bit-equal: a single run is sufficient.";
  std::vector<std::string> bounds;
  for (const auto& [system, count] : summary.confirming) {
    const double most = 1.0 - std::pow(0.05, 1.0 / static_cast<double>(count));
    bounds.push_back(fmt::format("up to {:.0f} % of the runs of {} ({})", 100.0 * most, system, count));
  }
  return fmt::format(
      "All repetitions are bit-equal. Of other systems and in real time, runs may still differ (95 % "
      "confidence; number of runs that repeat a first one): {}.",
      fmt::join(bounds, ", "));
}

int compare_repetitions(const Store& store, const RunSelection& selection, const StatsArguments& arguments) {
  StatsTable output{.header = {"run", "repetitions", "failed", "trajectories", "first difference"},
                    .kind = "stats_repeat",
                    .columns = {"sequence", "variant", "seed", "repetitions", "failed", "trajectories",
                                "bit_equal", "first_difference"},
                    .groups = {},
                    .notes = {}};
  RepetitionSummary summary;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}, .data = {}};
    for (const RepetitionRow& row : repetition_report(store, group.runs)) {
      summary.all_equal = summary.all_equal && row.is_repeatable();
      if (!repeats_by_design(row.identity))
        summary.confirming[system_and_mode(row.identity)] += row.repetitions - 1;
      const std::string unknown = row.distinct_trajectories == 1 ? "none" : "not recorded";
      rows.rows.push_back({row.label, fmt::format("{}", row.repetitions), fmt::format("{}", row.failed),
                           fmt::format("{}", row.distinct_trajectories),
                           row.first_difference.empty() ? unknown : row.first_difference});
      rows.data.push_back(joined_values(identity_values(row.identity),
                                        {report::data_value(row.repetitions), report::data_value(row.failed),
                                         report::data_value(row.distinct_trajectories), row.is_repeatable(),
                                         report::data_value(row.first_difference)}));
    }
    if (!rows.rows.empty()) output.groups.push_back(std::move(rows));
  }
  if (output.groups.empty())
    throw InputError(arguments.store, "contains no repeated run; set `repetitions = 2` in a plan");
  output.notes = with_left_out({repetition_note(summary)}, selection);
  print_stats(output, arguments);
  return summary.all_equal ? kExitOk : kExitFindings;
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

/// A row for each stage, or one if none is recorded.
std::vector<report::DataRow> difference_values(const ExecutionDifference& row) {
  const auto values = [&](const report::DataValue& stage, const report::DataValue& frame) {
    const bool compared = row.failure.empty();
    const auto if_compared = [&](const report::DataValue& value) {
      return compared ? value : report::DataValue();
    };
    return joined_values(identity_values(row.identity),
                         {report::data_value(row.failure), if_compared(report::data_value(row.frames)), stage,
                          frame, row.equal_trajectories, if_compared(row.largest_m),
                          if_compared(row.largest_rad * 180.0 / std::numbers::pi),
                          report::data_value(row.ate_m), report::data_value(row.other_ate_m)});
  };
  if (row.stages.empty()) return {values({}, {})};
  std::vector<report::DataRow> rows;
  for (const StageDifference& stage : row.stages) {
    report::DataValue frame;
    if (stage.frame) frame = *stage.frame;
    rows.push_back(values(stage.stage, frame));
  }
  return rows;
}

int compare_stores(const Store& store, const RunSelection& selection, const StatsArguments& arguments) {
  const Store other(arguments.other);
  StatsTable output{.header = {"run", "frames", "first frame that differs", "largest distance",
                               "largest angle", "ATE m", "ATE m, other"},
                    .kind = "stats_repeat_with",
                    .columns = {"sequence", "variant", "seed", "failure", "frames", "stage",
                                "first_frame_that_differs", "equal_trajectories", "largest_distance_m",
                                "largest_angle_deg", "ate_rmse_m", "other_ate_rmse_m"},
                    .groups = {},
                    .notes = {}};
  bool all_equal = true;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}, .data = {}};
    for (const ExecutionDifference& row : execution_differences(store, group.runs, other)) {
      all_equal = all_equal && row.equal_trajectories;
      rows.rows.push_back(difference_cells(row));
      for (report::DataRow& values : difference_values(row)) rows.data.push_back(std::move(values));
    }
    if (!rows.rows.empty()) output.groups.push_back(std::move(rows));
  }
  if (output.groups.empty()) {
    throw InputError(arguments.other, "contains no run that " + arguments.store +
                                          " contains, too: execute the same plan by the same build on both");
  }
  output.notes = with_left_out(
      {fmt::format("First frame that differs, by stage; -: none. Other: {}. {}", arguments.other,
                   all_equal ? "All trajectories are equal to nine decimals." : "Some trajectories differ.")},
      selection);
  print_stats(output, arguments);
  return all_equal ? kExitOk : kExitFindings;
}

}  // namespace

int stats_repeat(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  return arguments.other.empty() ? compare_repetitions(store, selection, arguments)
                                 : compare_stores(store, selection, arguments);
}

}  // namespace stillpoint::bench
