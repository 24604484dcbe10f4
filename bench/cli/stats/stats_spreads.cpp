// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint stats summary` and `sweep`.
#include <set>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/stats/stats_actions.h"
#include "core/base/counted.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {
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

/// Columns of `spread_values`.
std::vector<std::string> spread_columns() {
  return {"sequence",     "variant",       "axis",   "axis_value", "metric", "unit",       "runs",
          "failed",       "without_value", "copies", "n",          "median", "median_low", "median_high",
          "quartile_low", "quartile_high", "worst",  "modes",      "doubt"};
}

/// Median, its interval, quartiles and worst value in the unit of the metric.
report::DataRow spread_values(const RunSpread& row, const report::DataRow& metric_and_unit) {
  using report::data_value;
  report::DataRow values = {row.sequence, row.variant, data_value(row.axis),
                            row.axis.empty() ? report::DataValue() : report::DataValue(row.axis_value)};
  const auto add = [&values](const report::DataRow& more) {
    values.insert(values.end(), more.begin(), more.end());
  };
  add(metric_and_unit);
  add({data_value(row.runs), data_value(row.failed), data_value(row.without_value), data_value(row.copies),
       data_value(count_of(row))});
  if (row.spread) {
    add({row.spread->median});
    add(interval_values(row.spread->median_interval));
    add(interval_values(row.spread->quartiles));
    add({row.spread->worst, row.spread->modes ? data_value(*row.spread->modes) : report::DataValue()});
  } else {
    values.resize(values.size() + 7);
  }
  values.push_back(data_value(row.doubt));
  return values;
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
  const report::DataRow metric_and_unit = {metric, report::data_value(metric_unit(selection, metric))};
  for (const RunGroup& group : selection.groups) {
    GroupRows rows{.group = &group, .rows = {}, .data = {}};
    for (const RunSpread& row : run_spreads(group.runs, metric)) {
      if (!keep(row)) continue;
      result.counts.insert(count_of(row));
      result.copies += row.copies;
      result.without_value += row.without_value;
      if (!row.doubt.empty())
        result.doubts.push_back(fmt::format("{}{}, {}: {}.", group_prefix(selection, group), row.sequence,
                                            row.variant, row.doubt));
      rows.rows.push_back(cells(row));
      rows.data.push_back(spread_values(row, metric_and_unit));
    }
    if (!rows.rows.empty()) result.groups.push_back(std::move(rows));
  }
  return result;
}

/// The notes of a table of spreads: what its values are, and why some count less than others.
std::vector<std::string> spread_notes(const SpreadRows& rows, const RunSelection& selection,
                                      const std::string& metric) {
  std::vector<std::string> notes = {metric + "; n: different results with a value.",
                                    interval_note(kMedianTest, rows.counts)};
  if (rows.copies > 0) notes.push_back(copies_note(rows.copies, "run"));
  if (rows.without_value > 0)
    notes.push_back(without_value_note(counted(rows.without_value, "succeeded run")));
  return with_left_out(with_doubts(std::move(notes), rows.doubts), selection);
}

}  // namespace

int stats_summary(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  SpreadRows rows = spread_rows(
      selection, arguments.metric, [](const RunSpread&) { return true; }, summary_cells);
  std::vector<std::string> notes = spread_notes(rows, selection, arguments.metric);
  print_stats({.header = {"sequence", "variant", "sweep", "runs", "failed", "n", "median", "median 95 %",
                          "quartiles", "worst", "modes"},
               .kind = "stats_summary",
               .columns = spread_columns(),
               .groups = std::move(rows.groups),
               .notes = std::move(notes)},
              arguments);
  return kExitOk;
}

int stats_sweep(const StatsArguments& arguments) {
  const Store store(arguments.store);
  const RunSelection selection = chosen_runs(store, arguments);
  SpreadRows rows = spread_rows(
      selection, arguments.metric, [](const RunSpread& row) { return !row.axis.empty(); }, sweep_cells);
  if (rows.groups.empty())
    throw InputError(arguments.store, "contains no run of a sweep; add a [sweep] to a plan");
  std::vector<std::string> notes = spread_notes(rows, selection, arguments.metric);
  print_stats({.header = {"axis", "value", "sequence", "variant", "runs", "failed", "n", "median",
                          "median 95 % low", "high"},
               .kind = "stats_sweep",
               .columns = spread_columns(),
               .groups = std::move(rows.groups),
               .notes = std::move(notes)},
              arguments);
  return kExitOk;
}

}  // namespace stillpoint::bench
