// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/dataset_table.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "bench/model/metrics.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
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
  for (const bench::PublishedRow& system : systems)
    add_column("published", bench::system_label(system) + ", " + system.source);
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
  table.notes = published.comparability;
  for (const auto& [name, source] : published.sources) table.notes.push_back(name + ": " + source);
  return with_means(std::move(table));
}

}  // namespace stillpoint::report
