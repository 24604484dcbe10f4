// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/stats/stats_table.h"

#include <algorithm>
#include <array>
#include <iostream>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/config/spelling.h"
#include "bench/model/metrics.h"
#include "core/base/counted.h"
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

bool is_shown(const GroupColumn& column, const std::vector<GroupRows>& groups) {
  return std::any_of(groups.begin(), groups.end(), [&](const GroupRows& rows) {
    return rows.group->*column.value != groups.front().group->*column.value;
  });
}

/// The members of a group that differ between groups, followed by `cells`.
std::vector<std::string> with_group(const std::vector<GroupColumn>& columns, const RunGroup& group,
                                    const std::vector<std::string>& cells) {
  std::vector<std::string> all;
  all.reserve(columns.size() + cells.size());
  for (const GroupColumn& column : columns) all.push_back(group.*column.value);
  all.insert(all.end(), cells.begin(), cells.end());
  return all;
}

void print_for_readers(const StatsTable& table) {
  std::vector<GroupColumn> columns;
  std::vector<std::string> header;
  std::vector<std::string> common;
  const RunGroup& first = *table.groups.front().group;
  for (const GroupColumn& column : kGroupColumns) {
    if (is_shown(column, table.groups)) {
      columns.push_back(column);
      header.emplace_back(column.name);
    } else {
      common.push_back(fmt::format("{}: {}", column.name, first.*column.value));
    }
  }
  header.insert(header.end(), table.header.begin(), table.header.end());
  report::TableRows rows = {header};
  for (const GroupRows& group : table.groups) {
    for (const std::vector<std::string>& row : group.rows)
      rows.push_back(with_group(columns, *group.group, row));
  }
  std::cout << report::format_table(rows, report::TableStyle::kMarkdown) << '\n';
  if (!common.empty()) std::cout << fmt::format("{}\n", fmt::join(common, "; "));
  for (const std::string& note : table.notes) std::cout << note << '\n';
}

report::DataTable data_table(const StatsTable& table) {
  report::DataTable data{
      .kind = table.kind, .columns = {}, .rows = {}, .notes = table.notes, .version = table.version};
  for (const GroupColumn& column : kGroupColumns) data.columns.emplace_back(column.name);
  data.columns.insert(data.columns.end(), table.columns.begin(), table.columns.end());
  for (const GroupRows& group : table.groups) {
    for (const report::DataRow& values : group.data) {
      report::DataRow row;
      row.reserve(data.columns.size());
      for (const GroupColumn& column : kGroupColumns) row.emplace_back(group.group->*column.value);
      row.insert(row.end(), values.begin(), values.end());
      data.rows.push_back(std::move(row));
    }
  }
  return data;
}

}  // namespace

RunSelection chosen_runs(const Store& store, const StatsArguments& arguments) {
  std::vector<StoredRun> runs =
      arguments.plan.empty() ? store.run_headers() : runs_of_plan(store, arguments.plan);
  if (runs.empty())
    throw InputError(arguments.store, "contains no completed run; execute some with `stillpoint bench`");
  return select_runs(store, std::move(runs), arguments.build);
}

StatsArguments with_default_plan(const Store& store, StatsArguments arguments, const std::string& plan) {
  if (!arguments.plan.empty()) return arguments;
  std::vector<std::string> known;
  for (const StoredPlan& stored : store.plans()) known.push_back(stored.name);
  if (std::ranges::find(known, plan) == known.end())
    throw InputError(
        arguments.store,
        fmt::format("contains no plan \"{0}\"; execute it with `stillpoint bench {0} --store {1}`, or "
                    "name another plan with faults with --plan; it contains: {2}",
                    plan, arguments.store,
                    known.empty() ? "none" : fmt::format("{}", fmt::join(known, ", "))));
  arguments.plan = plan;
  return arguments;
}

void require_metric(const RunSelection& selection, const std::string& metric) {
  std::set<std::string> found;
  bool is_only_failed = true;  // then any known metric has the result "failed"
  for (const RunGroup& group : selection.groups) {
    for (const StoredRun& run : group.runs) {
      is_only_failed = is_only_failed && run.outcome != Outcome::kOk;
      for (const Metric& one : run.metrics) found.insert(one.name);
    }
  }
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

std::string copies_note(std::size_t copies, const char* what) {
  return fmt::format(
      "{} with the result of another seed or repetition to the bit: copies, which count once. Vary {} to "
      "obtain replicates of a deterministic run.",
      counted(copies, what), kPerturbationKey);
}

std::string without_value_note(const std::string& what) {
  return fmt::format("No finite value of the metric in {}; not failed, and not counted in n.", what);
}

std::vector<std::string> with_left_out(std::vector<std::string> notes, const RunSelection& selection) {
  notes.insert(notes.end(), selection.left_out.begin(), selection.left_out.end());
  return notes;
}

std::string group_prefix(const RunSelection& selection, const RunGroup& group) {
  std::vector<std::string> parts;
  for (const GroupColumn& column : kGroupColumns) {
    const bool differs = std::ranges::any_of(
        selection.groups, [&](const RunGroup& other) { return other.*column.value != group.*column.value; });
    if (differs) parts.push_back(fmt::format("{} {}", column.name, group.*column.value));
  }
  return parts.empty() ? "" : fmt::format("{}: ", fmt::join(parts, "; "));
}

std::vector<std::string> with_doubts(std::vector<std::string> notes, const std::vector<std::string>& doubts) {
  constexpr std::size_t kListed = 10;
  const std::size_t listed = std::min(kListed, doubts.size());
  notes.insert(notes.end(), doubts.begin(), doubts.begin() + static_cast<std::ptrdiff_t>(listed));
  if (doubts.size() > listed) notes.push_back(fmt::format("And {} more.", doubts.size() - listed));
  return notes;
}

std::string metric_unit(const RunSelection& selection, const std::string& metric) {
  for (const RunGroup& group : selection.groups) {
    for (const StoredRun& run : group.runs) {
      for (const Metric& one : run.metrics) {
        if (one.name == metric) return one.unit;
      }
    }
  }
  return "";
}

report::DataRow interval_values(const std::optional<eval::Interval>& interval) {
  if (!interval) return {report::DataValue(), report::DataValue()};
  return {interval->low, interval->high};
}

void print_stats(const StatsTable& table, const StatsArguments& arguments) {
  if (arguments.format == StatsFormat::kTable) return print_for_readers(table);
  const report::DataTable data = data_table(table);
  if (arguments.format == StatsFormat::kJson) {
    std::cout << report::data_json(data);
    return;
  }
  std::cout << report::data_csv(data);
  for (const std::string& note : table.notes) std::cerr << note << '\n';
}

}  // namespace stillpoint::bench
