// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/stats_table.h"

#include <algorithm>
#include <array>
#include <iostream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/config/spelling.h"
#include "bench/model/metrics.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr std::size_t kMaxListed = 20;
constexpr double kStatsSignificance = 0.05;

/// What distinguishes groups.
struct GroupColumn {
  const char* name;
  std::string RunGroup::*value;
};
constexpr std::array<GroupColumn, 3> kGroupColumns = {
    {{"build", &RunGroup::build}, {"machine", &RunGroup::machine}, {"mode", &RunGroup::mode}}};

bool is_shown(const GroupColumn& column, const std::vector<GroupRows>& groups, bool csv) {
  return csv || std::any_of(groups.begin(), groups.end(), [&](const GroupRows& rows) {
           return rows.group->*column.value != groups.front().group->*column.value;
         });
}

std::vector<std::string> joined(std::vector<std::string> cells, const std::vector<std::string>& more) {
  cells.insert(cells.end(), more.begin(), more.end());
  return cells;
}

/// Sentence about what all groups have in common.
std::string common_note(const std::vector<GroupRows>& groups, bool csv) {
  std::vector<std::string> parts;
  for (const GroupColumn& column : kGroupColumns) {
    if (!is_shown(column, groups, csv))
      parts.push_back(fmt::format("{}: {}", column.name, groups.front().group->*column.value));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace

RunSelection chosen_runs(const Store& store, const StatsArguments& arguments) {
  std::vector<StoredRun> runs =
      arguments.plan.empty() ? store.run_headers() : runs_of_plan(store, arguments.plan);
  if (runs.empty())
    throw InputError(arguments.store, "contains no completed run; execute some with `stillpoint bench`");
  return select_runs(store, std::move(runs), arguments.build);
}

void require_metric(const RunSelection& selection, const std::string& metric) {
  std::set<std::string> found;
  for (const RunGroup& group : selection.groups) {
    for (const StoredRun& run : group.runs) {
      for (const Metric& one : run.metrics) found.insert(one.name);
    }
  }
  const bool is_only_failed = found.empty();  // then any known metric has the result "failed"
  if (is_only_failed) {
    for (const MetricDescriptor& known : all_metrics()) found.emplace(known.id);
  }
  if (found.contains(metric)) return;
  std::vector<std::string> names(found.begin(), found.end());
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return spelling_distance(metric, a) < spelling_distance(metric, b);
  });
  const bool is_long = names.size() > kMaxListed;
  if (is_long) names.resize(kMaxListed);
  throw InputError("--metric", fmt::format("no run has \"{}\"; existing metrics, the nearest first: {}{}",
                                           metric, fmt::join(names, ", "), is_long ? ", ..." : ""));
}

std::string number_cell(double value) { return fmt::format("{:.5g}", value); }

std::string interval_cell(const std::optional<eval::Interval>& interval, std::size_t count) {
  if (!interval) return fmt::format("- (n = {})", count);
  return number_cell(interval->low) + " to " + number_cell(interval->high);
}

std::string interval_note(const std::string& test, const std::set<std::size_t>& counts) {
  const std::size_t smallest = eval::smallest_count(kStatsSignificance);
  const std::string note = fmt::format("95 % intervals: {}, from n = {} on", test, smallest);
  const auto large = counts.lower_bound(smallest);
  if (large == counts.begin() || *std::prev(large) == 0) return note + ".";
  const std::size_t count = *std::prev(large);
  return note + fmt::format("; the smallest two-sided p of n = {} is {:g}.", count, eval::smallest_p(count));
}

std::vector<std::string> with_left_out(std::vector<std::string> notes, const RunSelection& selection) {
  notes.insert(notes.end(), selection.left_out.begin(), selection.left_out.end());
  return notes;
}

std::vector<std::string> with_doubts(std::vector<std::string> notes, const std::vector<std::string>& doubts) {
  constexpr std::size_t kListed = 10;
  const std::size_t listed = std::min(kListed, doubts.size());
  notes.insert(notes.end(), doubts.begin(), doubts.begin() + static_cast<std::ptrdiff_t>(listed));
  if (doubts.size() > listed) notes.push_back(fmt::format("And {} more.", doubts.size() - listed));
  return notes;
}

void print_groups(const std::vector<std::string>& header, const std::vector<GroupRows>& groups,
                  const std::vector<std::string>& notes, const StatsArguments& arguments) {
  std::vector<GroupColumn> columns;
  for (const GroupColumn& column : kGroupColumns) {
    if (is_shown(column, groups, arguments.csv)) columns.push_back(column);
  }
  std::vector<std::string> names;
  names.reserve(columns.size());
  for (const GroupColumn& column : columns) names.emplace_back(column.name);
  report::TableRows table = {joined(names, header)};
  for (const GroupRows& group : groups) {
    std::vector<std::string> values;
    values.reserve(columns.size());
    for (const GroupColumn& column : columns) values.push_back(group.group->*column.value);
    for (const std::vector<std::string>& row : group.rows) table.push_back(joined(values, row));
  }
  std::cout << report::format_table(table,
                                    arguments.csv ? report::TableStyle::kCsv : report::TableStyle::kMarkdown);
  std::ostream& remarks = arguments.csv ? std::cerr : std::cout;
  if (!arguments.csv) remarks << '\n';
  if (const std::string common = common_note(groups, arguments.csv); !common.empty())
    remarks << common << '\n';
  for (const std::string& note : notes) remarks << note << '\n';
}

}  // namespace stillpoint::bench
