// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/result_tables.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/model/metrics.h"
#include "bench/model/run_notes.h"
#include "eval/metrics/statistics.h"
#include "reports/tables/run_cells.h"
#include "reports/tables/text_format.h"

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

/// Names the machines if there are several: medians over them are those of neither.
void add_machines(ReportTable& table, std::span<const bench::StoredRun> runs) {
  std::set<std::string> machines;
  for (const bench::StoredRun& run : runs) {
    if (!run.machine.empty()) machines.insert(run.machine);
  }
  if (machines.size() > 1)
    table.notes.push_back(
        fmt::format("Runs of {} machines are taken together: {}; `stillpoint stats` shows them separately.",
                    machines.size(), fmt::join(machines, "; ")));
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
  add_machines(table, runs);
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
  add_machines(table, runs);
  return table;
}

namespace {

/// The comparability of a published table, and the sources of the shown rows.
std::vector<std::string> published_notes(const bench::PublishedTable& published,
                                         const std::set<std::string>& shown) {
  std::vector<std::string> notes = published.comparability;
  for (const auto& [name, source] : published.sources) {
    if (shown.contains(name)) notes.push_back(fmt::format("{}: {}", name, source));
  }
  return notes;
}

}  // namespace

ReportTable published_comparison_table(std::span<const bench::StoredRun> runs,
                                       const bench::PublishedTable& published) {
  const bool is_cost = published.metric == "mean_ms";
  ReportTable table{.name = "published_" + published.name, .title = published.title, .row_heading = "system"};
  const std::vector<std::string> columns = shared_columns(runs, published);
  for (const std::string& column : columns)
    table.columns.push_back({.group = "", .name = column, .unit = published.unit, .decimals = 4});
  if (columns.empty()) return table;
  std::set<std::string> sources;
  for (const bench::PublishedRow& source : published.rows) {
    TableRow row = published_row(source, columns);
    const bool has_number = std::any_of(row.cells.begin(), row.cells.end(),
                                        [](const TableCell& cell) { return cell.number.has_value(); });
    if (!has_number) continue;
    sources.insert(source.source);
    table.rows.push_back(std::move(row));
  }
  for (const std::string& label : labels_of(runs)) {
    TableRow row{.label = label, .source = "ours", .cells = {}};
    for (const std::string& column : columns) {
      row.cells.push_back(is_cost ? undisturbed_time_cell(timed_runs_of(runs, label), column)
                                  : metric_cell(runs_of(runs, label, column), published.metric));
    }
    table.rows.push_back(std::move(row));
  }
  table.notes = published_notes(published, sources);
  return table;
}

namespace {

/// The published systems with a number for one of the sequences.
std::vector<bench::PublishedRow> shown_systems(const bench::PublishedTable& published,
                                               const std::vector<std::string>& sequences) {
  std::vector<bench::PublishedRow> shown;
  std::ranges::copy_if(published.rows, std::back_inserter(shown), [&](const bench::PublishedRow& row) {
    return std::ranges::any_of(sequences, [&](const std::string& name) { return row.values.contains(name); });
  });
  return shown;
}

/// The mean of the numbers of each column, and notes on how many there are.
ReportTable with_means(ReportTable table) {
  TableRow mean{.label = "mean", .source = "", .cells = {}};
  std::string counts;
  for (std::size_t column = 0; column < table.columns.size(); ++column) {
    std::vector<TableCell> cells;
    for (const TableRow& row : table.rows) {
      if (row.cells[column].number) cells.push_back(row.cells[column]);
    }
    mean.cells.push_back(mean_cell(cells));
    counts += fmt::format("{}{} {} of {}", counts.empty() ? "" : ", ", table.columns[column].name,
                          cells.size(), table.rows.size());
  }
  table.rows.push_back(std::move(mean));
  table.notes.push_back("Means are over the sequences with a number: " + counts +
                        ". Means over different sequences are not comparable.");
  return table;
}

}  // namespace

ReportTable dataset_table(const DatasetTableLayout& layout, std::span<const bench::StoredRun> runs,
                          const bench::PublishedTable& published) {
  const bench::MetricDescriptor& metric = *bench::find_metric(published.metric);
  ReportTable table{.name = layout.name,
                    .title = layout.title,
                    .description = bench::tooltip(metric),
                    .row_heading = "sequence"};
  const std::vector<bench::PublishedRow> systems = shown_systems(published, layout.sequences);
  const auto add_column = [&](const std::string& group, const std::string& name) {
    table.columns.push_back({.group = group,
                             .name = name,
                             .unit = std::string(metric.unit),
                             .decimals = metric.decimals,
                             .tooltip = table.description});
  };
  std::set<std::string> sources;
  for (const bench::PublishedRow& system : systems) {
    add_column("published", bench::system_label(system) + ", " + system.source);
    sources.insert(system.source);
  }
  for (const std::string& variant : layout.variants) add_column("ours", variant);
  for (const std::string& sequence : layout.sequences) {
    TableRow row{.label = sequence, .source = "", .cells = {}};
    for (const bench::PublishedRow& system : systems) {
      const auto found = system.values.find(sequence);
      TableCell& cell = row.cells.emplace_back();
      if (found == system.values.end()) continue;
      cell.number = found->second;
      cell.state = CellState::kOk;
      cell.note = system.note;
    }
    for (const std::string& variant : layout.variants)
      row.cells.push_back(metric_cell(runs_of(runs, variant, sequence), metric.id));
    table.rows.push_back(std::move(row));
  }
  table.notes = published_notes(published, sources);
  return with_means(std::move(table));
}

namespace {

/// Values by variant and column, in the order of first appearance.
struct Measured {
  std::vector<std::string> variants;
  std::vector<std::string> columns;
  std::map<std::pair<std::string, std::string>, std::vector<double>> values;
  std::size_t disturbed = 0;  ///< runs that were omitted because other processes may have changed their times

  void add(const std::string& variant, const std::string& column, double value) {
    if (std::find(variants.begin(), variants.end(), variant) == variants.end()) variants.push_back(variant);
    if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
    values[{variant, column}].push_back(value);
  }
};

Measured measured(std::span<const bench::StoredRun> runs, const bench::PublishedTable& published) {
  Measured table;
  for (const bench::StoredRun& run : runs) {
    if (run.outcome != bench::Outcome::kOk || !run.identity.axis.empty()) continue;
    if (published.metric == "mean_ms") {
      const bool is_disturbed = bench::time_source(run) != bench::TimeSource::kUndisturbed;
      table.disturbed += is_disturbed && !run.costs.empty() ? 1 : 0;
      if (is_disturbed) continue;
      for (const bench::ModuleCost& cost : run.costs)
        table.add(run.identity.variant, cost.module, cost.mean_ms);
    } else if (const std::optional<double> value = bench::metric_value(run, published.metric)) {
      table.add(run.identity.variant, run.identity.sequence, *value);
    }
  }
  return table;
}

/// Columns that also occur in a published row.
std::vector<std::string> columns_in_both(const Measured& table, const bench::PublishedTable& published) {
  std::vector<std::string> shared;
  std::copy_if(
      table.columns.begin(), table.columns.end(), std::back_inserter(shared), [&](const std::string& column) {
        return std::any_of(published.rows.begin(), published.rows.end(),
                           [&](const bench::PublishedRow& row) { return row.values.contains(column); });
      });
  return shared;
}

std::string number(double value) { return fmt::format("{:.4f}", value); }

std::vector<std::string> published_cells(const bench::PublishedRow& row,
                                         const std::vector<std::string>& columns) {
  std::vector<std::string> cells = {bench::system_label(row), "published, " + row.source};
  for (const std::string& column : columns) {
    const auto found = row.values.find(column);
    cells.push_back(found == row.values.end() ? "-" : number(found->second));
  }
  return cells;
}

std::vector<std::string> measured_cells(const Measured& table, const std::string& variant,
                                        const std::vector<std::string>& columns) {
  std::vector<std::string> cells = {variant, "measured"};
  for (const std::string& column : columns) {
    const auto found = table.values.find({variant, column});
    cells.push_back(found == table.values.end() ? "n/a" : number(*eval::percentile(found->second, 0.5)));
  }
  return cells;
}

/// One line for each cell whose protocol differs much from a strict one of the same runs.
std::string protocol_lines(std::span<const bench::StoredRun> runs, const Measured& table,
                           const std::vector<std::string>& columns, const std::string& metric) {
  std::string text;
  for (const std::string& variant : table.variants) {
    for (const std::string& sequence : columns) {
      std::vector<const bench::StoredRun*> own;
      for (const bench::StoredRun& run : runs) {
        const bench::RunIdentity& identity = run.identity;
        if (identity.variant == variant && identity.sequence == sequence && identity.axis.empty())
          own.push_back(&run);
      }
      const std::string note = bench::protocol_difference_note(own, metric);
      if (!note.empty()) text += fmt::format("- {} on {}: {}\n", variant, sequence, note);
    }
  }
  return text;
}

std::string omission_sentence(std::size_t disturbed) {
  if (disturbed == 0) return "";
  return fmt::format(
      "The times of {} run{} are not compared, because only timing runs on an idle machine give times: "
      "execute a plan with kind = \"timing\" into a new store while the machine is idle.",
      disturbed, disturbed == 1 ? "" : "s");
}

}  // namespace

std::string published_comparison(std::span<const bench::StoredRun> runs,
                                 const bench::PublishedTable& published) {
  const Measured table = measured(runs, published);
  const std::vector<std::string> columns = columns_in_both(table, published);
  const std::string omitted = omission_sentence(table.disturbed);
  if (columns.empty()) return omitted.empty() ? "" : published.title + ": " + omitted + "\n";
  TableRows rows = {{"system", "source"}};
  rows.front().insert(rows.front().end(), columns.begin(), columns.end());
  for (const std::string& variant : table.variants) rows.push_back(measured_cells(table, variant, columns));
  std::set<std::string> sources;
  std::string notes;
  for (const bench::PublishedRow& row : published.rows) {
    const bool any = std::any_of(columns.begin(), columns.end(),
                                 [&](const std::string& column) { return row.values.contains(column); });
    if (!any) continue;
    rows.push_back(published_cells(row, columns));
    sources.insert(row.source);
    if (!row.note.empty()) notes += fmt::format("- {} ({}): {}\n", row.system, row.source, row.note);
  }
  std::string text = fmt::format("{} [{}]; measured: medians; published: alignment {}\n\n", published.title,
                                 published.unit, published.alignment);
  text += format_table(rows, TableStyle::kMarkdown) + "\n";
  for (const std::string& sentence : published.comparability) text += "- " + sentence + "\n";
  if (!omitted.empty()) text += "- " + omitted + "\n";
  text += protocol_lines(runs, table, columns, published.metric);
  text += notes;
  for (const std::string& source : sources)
    text += fmt::format("- {}: {}\n", source, published.sources.at(source));
  return text;
}

}  // namespace stillpoint::report
