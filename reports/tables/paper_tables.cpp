// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/paper_tables.h"

#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "bench/model/metrics.h"
#include "bench/systems/published_table.h"
#include "core/base/module_timings.h"
#include "reports/tables/run_cells.h"

namespace stillpoint::report {
namespace {

/// A column group: a system of the paper and the variant that corresponds to it.
struct PaperSystem {
  const char* heading;
  const char* published;
  const char* variant;  ///< empty: no such variant
};

struct PaperMetric {
  const bench::MetricDescriptor* metric;
  bench::PublishedTable published;
};
using PaperMetrics = std::array<PaperMetric, 3>;

constexpr std::array<const char*, 4> kSequences = {"walking_xyz", "walking_static", "walking_rpy",
                                                   "walking_halfsphere"};
constexpr const char* kDuplicateNote =
    "the paper prints the same three numbers for another sequence: a copying error, not used as a target";

const bench::PublishedRow* paper_row(const bench::PublishedTable& table, const std::string& system) {
  for (const bench::PublishedRow& row : table.rows) {
    if (row.source == "paper" && row.system == system) return &row;
  }
  return nullptr;
}

std::optional<double> published_value(const PaperMetric& metric, const PaperSystem& system,
                                      const std::string& sequence) {
  const bench::PublishedRow* row = paper_row(metric.published, system.published);
  if (row == nullptr) return std::nullopt;
  const auto found = row->values.find(sequence);
  return found == row->values.end() ? std::nullopt : std::optional(found->second);
}

/// Whether the paper gives the same three numbers for another sequence of that system, which is implausible.
bool is_duplicate(const PaperMetrics& metrics, const PaperSystem& system, const std::string& sequence) {
  return std::any_of(kSequences.begin(), kSequences.end(), [&](const std::string& other) {
    return other != sequence && std::all_of(metrics.begin(), metrics.end(), [&](const PaperMetric& metric) {
             const std::optional<double> value = published_value(metric, system, sequence);
             return value && value == published_value(metric, system, other);
           });
  });
}

TableCell published_cell(const PaperMetrics& metrics, std::size_t metric, const PaperSystem& system,
                         const std::string& sequence) {
  TableCell cell{.number = published_value(metrics[metric], system, sequence)};
  if (!cell.number) return cell;
  cell.state = CellState::kOk;
  cell.is_suspicious = is_duplicate(metrics, system, sequence);
  if (cell.is_suspicious) cell.note = kDuplicateNote;
  return cell;
}

TableCell difference_cell(const TableCell& ours, const TableCell& published) {
  if (!ours.number || !published.number) return {};
  TableCell cell{.number = *ours.number - *published.number, .state = ours.state};
  cell.is_suspicious = published.is_suspicious;
  cell.note = published.note;
  return cell;
}

/// The runs of a variant on a sequence: a rendered one, or the recording.
std::vector<const bench::StoredRun*> own_runs(std::span<const bench::StoredRun> runs,
                                              const PaperSystem& system, const std::string& sequence,
                                              const bench::PublishedTable& published) {
  std::vector<const bench::StoredRun*> rendered = runs_of(runs, system.variant, sequence);
  const auto recording = published.recordings.find(sequence);
  if (!rendered.empty() || recording == published.recordings.end()) return rendered;
  return runs_of(runs, system.variant, recording->second);
}

/// Published, ours and difference of one sequence.
std::vector<TableRow> sequence_rows(std::span<const bench::StoredRun> runs, const std::string& sequence,
                                    const PaperMetrics& metrics, std::span<const PaperSystem> systems) {
  std::vector<TableRow> rows = {
      {sequence, "published", {}}, {sequence, "ours", {}}, {sequence, "difference", {}}};
  for (const PaperSystem& system : systems) {
    const auto own = own_runs(runs, system, sequence, metrics.front().published);
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      rows[0].cells.push_back(published_cell(metrics, i, system, sequence));
      rows[1].cells.push_back(metric_cell(own, metrics[i].metric->id));
      rows[2].cells.push_back(difference_cell(rows[1].cells.back(), rows[0].cells.back()));
    }
  }
  return rows;
}

/// Means over the sequences with a number in each column of "ours" that has any. Sequences without data
/// remain in the table but not in the means; the label tells how many are left. Empty without such a
/// sequence.
std::vector<TableRow> mean_rows(const std::vector<TableRow>& rows) {
  constexpr std::size_t kRowsPerSequence = 3;
  const std::size_t columns = rows.front().cells.size();
  const auto has_number = [&](std::size_t row, std::size_t column) {
    return rows[row].cells[column].number.has_value();
  };
  std::vector<std::size_t> complete;
  for (std::size_t first = 0; first < rows.size(); first += kRowsPerSequence) {
    bool is_complete = false;
    for (std::size_t column = 0; column < columns; ++column) {
      bool is_used = false;
      for (std::size_t other = 1; other < rows.size(); other += kRowsPerSequence)
        is_used = is_used || has_number(other, column);
      if (is_used) is_complete = has_number(first + 1, column);
      if (is_used && !is_complete) break;
    }
    if (is_complete) complete.push_back(first);
  }
  if (complete.empty()) return {};
  std::vector<TableRow> means;
  for (std::size_t kind = 0; kind < kRowsPerSequence; ++kind) {
    TableRow& mean = means.emplace_back(
        TableRow{fmt::format("mean of {} of {} sequences", complete.size(), rows.size() / kRowsPerSequence),
                 rows[kind].source,
                 {}});
    for (std::size_t column = 0; column < columns; ++column) {
      std::vector<TableCell> cells;
      cells.reserve(complete.size());
      for (const std::size_t first : complete) cells.push_back(rows[first + kind].cells[column]);
      mean.cells.push_back(mean_cell(cells));
    }
  }
  return means;
}

/// The row with the best system of each metric marked.
TableRow with_best_systems(TableRow row) {
  constexpr std::size_t kMetrics = std::tuple_size_v<PaperMetrics>;
  for (std::size_t metric = 0; metric < kMetrics; ++metric) {
    std::vector<TableCell*> cells;
    for (std::size_t i = metric; i < row.cells.size(); i += kMetrics) cells.push_back(&row.cells[i]);
    const auto numbers = std::count_if(cells.begin(), cells.end(),
                                       [](const TableCell* cell) { return cell->number.has_value(); });
    if (numbers > 1) mark_best(cells, false);
  }
  return row;
}

/// Whether a number can come from a rendered sequence, which has the name of the row, and not from a
/// recording.
bool contain_rendered(std::span<const bench::StoredRun> runs) {
  return std::ranges::any_of(runs, [](const bench::StoredRun& run) {
    return std::ranges::find(kSequences, run.identity.sequence) != std::end(kSequences);
  });
}

ReportTable accuracy_table(ReportTable table, std::span<const bench::StoredRun> runs,
                           const PaperMetrics& metrics, std::span<const PaperSystem> systems) {
  table.row_heading = "sequence";
  for (const PaperSystem& system : systems) {
    for (const PaperMetric& metric : metrics)
      table.columns.push_back({.group = system.heading,
                               .name = std::string(metric.metric->label),
                               .unit = std::string(metric.metric->unit),
                               .decimals = 4,
                               .tooltip = bench::tooltip(*metric.metric)});
  }
  std::vector<TableRow> rows;
  for (const char* sequence : kSequences)
    std::ranges::move(sequence_rows(runs, sequence, metrics, systems), std::back_inserter(rows));
  std::ranges::move(mean_rows(rows), std::back_inserter(rows));
  for (TableRow& row : rows)
    table.rows.push_back(row.source == "difference" ? std::move(row) : with_best_systems(std::move(row)));
  table.notes.emplace_back("Published rows, bold: best number of a row. Difference: ours minus published.");
  table.notes.emplace_back("Rows \"ours\": medians over runs.");
  if (std::string note = best_note(table, "row", false); !note.empty())
    table.notes.push_back(std::move(note));
  if (contain_rendered(runs))
    table.notes.emplace_back(
        "Rendered sequences reproduce the motions of the recordings but not their images; results "
        "on them are not directly comparable with the published ones.");
  return table;
}

PaperMetrics metrics_of(const std::string& prefix) {
  const auto metric_of = [&](const std::string& suffix) {
    bench::PublishedTable published = bench::load_published(prefix + suffix);
    return PaperMetric{bench::find_metric(published.metric), std::move(published)};
  };
  return {metric_of("_ate"), metric_of("_rpe_trans"), metric_of("_rpe_rot")};
}

ReportTable table1(std::span<const bench::StoredRun> runs) {
  constexpr PaperSystem kSystems[] = {{"ORB-SLAM2", "ORB-SLAM2", ""},
                                      {"DS-SLAM", "DS-SLAM", ""},
                                      {"Ji et al.", "Ji et al. 2021", ""},
                                      {"Dynamic-VINS", "Dynamic-VINS (VO)", "dynamic_vins_vo"}};
  return accuracy_table(
      {.name = "table1", .title = "Table I: RMSE of ATE, T.RPE and R.RPE on TUM RGB-D fr3 walking"}, runs,
      metrics_of("tum_fr3"), kSystems);
}

ReportTable table2(std::span<const bench::StoredRun> runs) {
  constexpr PaperSystem kSystems[] = {
      {"W/O circular mask", "Dynamic-VINS wo_circular_mask", "dynamic_vins_vo+wo_circular_mask"},
      {"W/O object detection", "Dynamic-VINS wo_object_detection", "dynamic_vins_vo+wo_object_detection"},
      {"W/O seg-like mask", "Dynamic-VINS wo_seg_like_mask", "dynamic_vins_vo+wo_seg_like_mask"},
      {"W/O MCC", "Dynamic-VINS wo_mcc", "dynamic_vins_vo+wo_mcc"}};
  return accuracy_table(
      {.name = "table2",
       .title = "Table II: ablation, RMSE of ATE, T.RPE and R.RPE on TUM RGB-D fr3 walking"},
      runs, metrics_of("tum_fr3_ablation"), kSystems);
}

/// A column of Table III.
struct PaperModule {
  Module module;
  const char* heading;

  [[nodiscard]] std::string name() const { return std::string(module_name(module)); }
};
constexpr PaperModule kModules[] = {{Module::kFeatureTracking, "Feature Tracking"},
                                    {Module::kFeatureDetection, "Feature Detection"},
                                    {Module::kTrackingThread, "Tracking Thread*"},
                                    {Module::kDynamicRecognition, "Dynamic Feature Recognition"},
                                    {Module::kStateOptimization, "State Optimization"},
                                    {Module::kOptimizationThread, "Optimization Thread*"},
                                    {Module::kObjectDetection, "Object Detection*"}};

ReportTable table3(std::span<const bench::StoredRun> runs) {
  ReportTable table{
      .name = "table3",
      .title = "Table III: average computation time of each module and thread on OpenLORIS market",
      .row_heading = "method"};
  for (const PaperModule& module : kModules)
    table.columns.push_back({.group = "",
                             .name = module.heading,
                             .unit = "ms",
                             .decimals = 4,
                             .tooltip = bench::tooltip_of(module.name())});
  for (const bench::PublishedRow& published : bench::load_published("runtime_market").rows) {
    TableRow& row = table.rows.emplace_back(TableRow{published.system, "published", {}});
    for (const PaperModule& module : kModules) {
      TableCell& cell = row.cells.emplace_back();
      const auto found = published.values.find(module.name());
      if (found == published.values.end()) continue;
      cell.number = found->second;
      cell.state = CellState::kOk;
    }
  }
  for (const std::string& label : distinct(runs, system_label)) {
    TableRow& row = table.rows.emplace_back(TableRow{label, "ours", {}});
    for (const PaperModule& module : kModules)
      row.cells.push_back(undisturbed_time_cell(timed_runs_of(runs, label), module.name()));
  }
  table.notes = {
      "* separate thread, averaged per frame; modules are averaged per call.",
      "Ours: timing runs on an idle machine only.",
      "Dynamic Feature Recognition is the sum of recognition, missed detection compensation and moving "
      "consistency check.",
      "Published times are from other devices: only ratios between rows of one device are comparable, hence "
      "no difference."};
  return table;
}

}  // namespace

std::optional<PaperTable> paper_table_of(std::string_view plan) {
  if (plan.starts_with("table1_")) return PaperTable::kTable1;
  if (plan.starts_with("table2_")) return PaperTable::kTable2;
  if (plan.starts_with("table3_")) return PaperTable::kTable3;
  return std::nullopt;
}

ReportTable paper_table(PaperTable table, std::span<const bench::StoredRun> runs) {
  switch (table) {
    case PaperTable::kTable1:
      return table1(runs);
    case PaperTable::kTable2:
      return table2(runs);
    case PaperTable::kTable3:
      return table3(runs);
  }
  return {};
}

}  // namespace stillpoint::report
