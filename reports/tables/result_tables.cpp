// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/result_tables.h"

#include <algorithm>

#include "bench/model/metrics.h"
#include "reports/tables/run_cells.h"
#include "reports/tables/timing_runs.h"

namespace stillpoint::report {
namespace {

bool is_outside_sweeps(const bench::StoredRun& run) { return run.identity.axis.empty(); }

bool has_metric(std::span<const bench::StoredRun> runs, std::string_view name) {
  return std::any_of(runs.begin(), runs.end(), [&](const bench::StoredRun& run) {
    return is_outside_sweeps(run) && bench::metric_value(run, name).has_value();
  });
}

std::vector<std::string> labels_of(std::span<const bench::StoredRun> runs) {
  return distinct(runs, system_label);
}

/// The table with the best number of each column marked, and what the marks mean.
ReportTable with_best_in_columns(ReportTable table, bool larger_is_better) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    std::vector<TableCell*> cells;
    for (TableRow& row : table.rows) cells.push_back(&row.cells[i]);
    mark_best(cells, larger_is_better);
  }
  if (std::string note = best_note(table, "column", larger_is_better); !note.empty())
    table.notes.push_back(std::move(note));
  return table;
}

/// Whether other processes on the machine change a metric.
bool is_time_of_process(const bench::MetricDescriptor& metric) {
  return metric.source == bench::MetricSource::kProcess && metric.unit == "s";
}

/// A cell of the metric over the runs of a variant on a sequence; times of undisturbed timing runs, if
/// possible.
TableCell result_cell(const std::vector<const bench::StoredRun*>& runs,
                      const bench::MetricDescriptor& metric) {
  if (!is_time_of_process(metric)) return metric_cell(runs, metric.id);
  const TimedRuns timed = timed_runs(runs);
  TableCell cell = metric_cell(timed.runs, metric.id);
  return cell.number ? with_note(std::move(cell), bench::time_source_note(timed.source)) : cell;
}

ReportTable metric_table(std::span<const bench::StoredRun> runs, const bench::MetricDescriptor& metric) {
  ReportTable table{.name = std::string(metric.id),
                    .title = std::string(metric.title),
                    .description = bench::tooltip(metric),
                    .row_heading = "variant"};
  const std::vector<std::string> sequences = sequences_of(runs);
  for (const std::string& sequence : sequences) {
    table.columns.push_back({.group = "",
                             .name = sequence,
                             .unit = std::string(metric.unit),
                             .decimals = metric.decimals,
                             .tooltip = table.description});
  }
  for (const std::string& label : labels_of(runs)) {
    TableRow row{.label = label, .source = "", .cells = {}};
    for (const std::string& sequence : sequences)
      row.cells.push_back(result_cell(runs_of(runs, label, sequence), metric));
    table.rows.push_back(std::move(row));
  }
  table.notes = {"Medians over n successful runs; equal repetitions of a deterministic run count once."};
  // Costs depend on the machine and on what a system computes: no system is best.
  const bool has_best = metric.source == bench::MetricSource::kTrajectory;
  return has_best ? with_best_in_columns(std::move(table),
                                         metric.direction == bench::MetricDirection::kLargerIsBetter)
                  : table;
}

std::vector<std::string> modules_of(std::span<const bench::StoredRun> runs) {
  std::vector<std::string> modules;
  for (const bench::StoredRun& run : runs) {
    for (const bench::ModuleCost& cost : run.costs) {
      if (std::find(modules.begin(), modules.end(), cost.module) == modules.end())
        modules.push_back(cost.module);
    }
  }
  return modules;
}

/// Columns that occur both in a published row and in a run.
std::vector<std::string> shared_columns(std::span<const bench::StoredRun> runs,
                                        const bench::PublishedTable& published) {
  std::vector<std::string> names = published.metric == "mean_ms" ? modules_of(runs) : sequences_of(runs);
  std::erase_if(names, [&](const std::string& name) {
    return std::none_of(published.rows.begin(), published.rows.end(),
                        [&](const bench::PublishedRow& row) { return row.values.contains(name); });
  });
  return names;
}

TableRow published_row(const bench::PublishedRow& published, const std::vector<std::string>& columns) {
  TableRow row{
      .label = bench::system_label(published) + ", " + published.source, .source = "published", .cells = {}};
  for (const std::string& column : columns) {
    TableCell& cell = row.cells.emplace_back();
    const auto found = published.values.find(column);
    if (found == published.values.end()) continue;
    cell.number = found->second;
    cell.state = CellState::kOk;
    cell.note = published.note;
  }
  return row;
}

}  // namespace

std::vector<ReportTable> metric_tables(std::span<const bench::StoredRun> runs) {
  std::vector<bench::StoredRun> shown(runs.begin(), runs.end());
  std::erase_if(shown, [](const bench::StoredRun& run) { return !is_outside_sweeps(run); });
  std::vector<ReportTable> tables;
  for (const bench::MetricDescriptor& metric : bench::all_metrics()) {
    if (metric.title.empty()) continue;
    // The first table is kept even if every run failed, to show the failures.
    if (&metric == &bench::headline_metric() ? !shown.empty() : has_metric(shown, metric.id))
      tables.push_back(metric_table(shown, metric));
  }
  return tables;
}

ReportTable cost_table(std::span<const bench::StoredRun> runs) {
  ReportTable table{
      .name = "module_times", .title = "Mean time of modules and threads", .row_heading = "variant"};
  const std::vector<std::string> modules = modules_of(runs);
  for (const std::string& module : modules)
    table.columns.push_back(
        {.group = "", .name = module, .unit = "ms", .decimals = 3, .tooltip = bench::tooltip_of(module)});
  if (modules.empty()) return table;
  for (const std::string& label : labels_of(runs)) {
    TableRow row{.label = label, .source = "", .cells = {}};
    for (const std::string& module : modules)
      row.cells.push_back(time_cell(timed_runs_of(runs, label), module));
    table.rows.push_back(std::move(row));
  }
  table.notes = {"Modules are averaged per call, threads per frame; median over all runs of a variant."};
  return table;
}

ReportTable published_comparison_table(std::span<const bench::StoredRun> runs,
                                       const bench::PublishedTable& published) {
  const bool is_cost = published.metric == "mean_ms";
  ReportTable table{.name = "published_" + published.name, .title = published.title, .row_heading = "system"};
  const std::vector<std::string> columns = shared_columns(runs, published);
  for (const std::string& column : columns)
    table.columns.push_back({.group = "", .name = column, .unit = published.unit, .decimals = 4});
  if (columns.empty()) return table;
  for (const bench::PublishedRow& source : published.rows) {
    TableRow row = published_row(source, columns);
    const bool has_number = std::any_of(row.cells.begin(), row.cells.end(),
                                        [](const TableCell& cell) { return cell.number.has_value(); });
    if (has_number) table.rows.push_back(std::move(row));
  }
  for (const std::string& label : labels_of(runs)) {
    TableRow row{.label = label, .source = "ours", .cells = {}};
    for (const std::string& column : columns) {
      row.cells.push_back(is_cost ? undisturbed_time_cell(timed_runs_of(runs, label), column)
                                  : metric_cell(runs_of(runs, label, column), published.metric));
    }
    table.rows.push_back(std::move(row));
  }
  table.notes = published.comparability;
  for (const auto& [name, source] : published.sources) table.notes.push_back(name + ": " + source);
  return table;
}

}  // namespace stillpoint::report
