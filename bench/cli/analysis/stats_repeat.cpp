// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/stats_repeat.h"

#include <numbers>

#include <fmt/format.h>

#include "bench/analysis/execution_difference.h"
#include "bench/cli/command_line.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

int compare_repetitions(const Store& store, const RunSelection& selection, const StatsArguments& arguments) {
  std::vector<GroupRows> groups;
  bool all_equal = true;
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}};
    for (const RepetitionRow& row : repetition_report(store, group.runs)) {
      const bool is_equal = row.distinct_trajectories == 1 && row.first_difference.empty();
      all_equal = all_equal && is_equal;
      const std::string unknown = row.distinct_trajectories == 1 ? "none" : "not recorded";
      rows.rows.push_back({row.label, fmt::format("{}", row.repetitions),
                           fmt::format("{}", row.distinct_trajectories),
                           row.first_difference.empty() ? unknown : row.first_difference});
    }
    if (!rows.rows.empty()) groups.push_back(std::move(rows));
  }
  if (groups.empty())
    throw InputError(arguments.store, "contains no repeated run; set `repetitions = 2` in a plan");
  print_groups({"run", "repetitions", "trajectories", "first difference"}, groups,
               with_left_out({all_equal ? "All repetitions are bit-equal: a single run is sufficient."
                                        : "Some repetitions differ: evaluate the spread over repetitions."},
                             selection),
               arguments);
  return all_equal ? kExitOk : kExitFindings;
}

std::string ate_cell(const std::optional<double>& ate) { return ate ? number_cell(*ate) : "n/a"; }

std::vector<std::string> difference_cells(const ExecutionDifference& row) {
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
    throw InputError(arguments.other, "contains no successful run that " + arguments.store +
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

}  // namespace

int stats_repeat(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  return arguments.other.empty() ? compare_repetitions(store, selection, arguments)
                                 : compare_stores(store, selection, arguments);
}

}  // namespace stillpoint::bench
