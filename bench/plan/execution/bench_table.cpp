// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/bench_table.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <unordered_map>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/model/metrics.h"
#include "bench/record/result_values.h"
#include "eval/metrics/statistics.h"
#include "eval/statistics/modes.h"

namespace stillpoint::bench {
namespace {

/// The runs that a row aggregates.
struct Group {
  const PlannedRun* first = nullptr;
  std::vector<const StoredRun*> runs;
};

using GroupKey = std::tuple<std::string, std::string, std::string, double>;

/// Groups in the order of their first runs.
std::vector<Group> groups_of(const PlanMatrix& matrix,
                             const std::unordered_map<std::string, StoredRun>& stored) {
  std::vector<Group> groups;
  std::map<GroupKey, std::size_t> index;
  for (const PlannedRun& run : matrix.runs) {
    const RunIdentity& identity = run.identity;
    const GroupKey key{identity.sequence, identity.variant, identity.axis, identity.axis_value};
    const auto [entry, is_new] = index.insert({key, groups.size()});
    if (is_new) groups.push_back({.first = &run, .runs = {}});
    const auto found = stored.find(run_key(identity));
    if (found != stored.end()) groups[entry->second].runs.push_back(&found->second);
  }
  return groups;
}

std::optional<double> median_of(const std::vector<const StoredRun*>& runs, std::string_view metric) {
  std::vector<double> values;
  for (const StoredRun* run : runs) {
    if (const std::optional<double> value = metric_value(*run, metric)) values.push_back(*value);
  }
  return eval::percentile(values, 0.5);
}

std::optional<double> median_cost(const std::vector<const StoredRun*>& runs, std::string_view module) {
  std::vector<double> values;
  for (const StoredRun* run : runs) {
    for (const ModuleCost& cost : run->costs) {
      if (cost.module == module) values.push_back(cost.mean_ms);
    }
  }
  return eval::percentile(values, 0.5);
}

std::string load_note(const std::vector<const StoredRun*>& runs) {
  const std::optional<double> load = median_of(runs, metric_id::kOtherLoad);
  if (median_of(runs, metric_id::kQuiet) != 0.0 || !load) return "";
  return fmt::format("the machine was not idle: other processes used {:.0f} % of the CPU", 100.0 * *load);
}

std::string doubts_of(const std::vector<const StoredRun*>& runs) {
  const std::string_view headline = headline_metric().id;
  return joined_notes({missing_boxes_note(runs), doubtful_error_note(runs, headline), load_note(runs),
                       protocol_difference_note(runs, headline), scatter_note(runs, headline),
                       few_rpe_pairs_note(runs, metric_id::kRpeTranslation), innovation_note(runs)});
}

/// A row with availability, outcome and reason.
BenchRow row_with_outcome(const std::vector<const StoredRun*>& runs, const std::string& unavailable_reason) {
  BenchRow row{.is_available = unavailable_reason.empty(), .reason = unavailable_reason};
  if (!runs.empty()) row.outcome = Outcome::kOk;
  for (const StoredRun* run : runs) {
    if (run->outcome != Outcome::kOk && row.reason.empty()) {
      row.outcome = run->outcome;
      row.reason = run->detail;
    }
  }
  if (row.reason.empty()) row.reason = doubts_of(runs);
  return row;
}

BenchRow row_of(const Group& group, const std::string& unavailable_reason) {
  const RunIdentity& identity = group.first->identity;
  BenchRow row = row_with_outcome(group.runs, unavailable_reason);
  row.sequence = identity.sequence;
  row.variant = identity.variant;
  if (!identity.axis.empty()) row.sweep = fmt::format("{} = {}", identity.axis, identity.axis_value);
  std::vector<const StoredRun*> succeeded;
  std::copy_if(group.runs.begin(), group.runs.end(), std::back_inserter(succeeded),
               [](const StoredRun* run) { return run->outcome == Outcome::kOk; });
  row.runs = group.runs.size();
  row.succeeded_runs = succeeded.size();
  for (const StoredRun* run : succeeded) row.time_source = std::max(row.time_source, time_source(*run));
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory)) {
    if (const std::optional<double> median = median_of(succeeded, metric->id))
      row.metrics[std::string(metric->id)] = *median;
  }
  std::set<double> values;  // equal ones are copies of one result
  for (const StoredRun* run : succeeded) {
    if (const auto value = metric_value(*run, headline_metric().id)) values.insert(*value);
  }
  if (!values.empty()) row.worst = *values.rbegin();
  row.modes = eval::mode_count(std::vector<double>(values.begin(), values.end()));
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    row.mean_ms[i] = median_cost(succeeded, module_name(static_cast<Module>(i)));
  }
  return row;
}

}  // namespace

std::vector<BenchRow> plan_rows(const PlanMatrix& matrix, const Store& store) {
  std::unordered_map<std::string, StoredRun> stored;
  for (StoredRun& run : store.runs()) stored[run.key] = std::move(run);
  std::vector<BenchRow> rows;
  for (const Group& group : groups_of(matrix, stored)) {
    rows.push_back(row_of(group, matrix.sequences[group.first->sequence].unavailable_reason));
  }
  return rows;
}

namespace {

/// "ok", the name of another outcome, "not run" or "skipped".
std::string row_status(const BenchRow& row) {
  if (!row.is_available) return "skipped";
  return row.outcome ? outcome_name(*row.outcome) : "not run";
}

using Cells = std::vector<std::string>;
using Json = nlohmann::ordered_json;

/// The columns of the paper's Table III, in its order, and their headings in this table.
struct TimedColumn {
  Module module;
  const char* title;
};
constexpr TimedColumn kTimedColumns[] = {
    {Module::kFeatureTracking, "track"},          {Module::kFeatureDetection, "detect"},
    {Module::kTrackingThread, "tracking thread"}, {Module::kDynamicRecognition, "dynamic"},
    {Module::kStateOptimization, "state opt"},    {Module::kOptimizationThread, "optim thread"},
    {Module::kObjectDetection, "objects"}};

std::string cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "n/a";
}

std::vector<TimedColumn> present_columns(std::span<const BenchRow> rows) {
  std::vector<TimedColumn> present;
  for (const TimedColumn& column : kTimedColumns) {
    const bool any = std::any_of(rows.begin(), rows.end(), [&](const BenchRow& row) {
      return row.mean_ms[static_cast<std::size_t>(column.module)].has_value();
    });
    if (any) present.push_back(column);
  }
  return present;
}

std::optional<double> metric_of(const BenchRow& row, const MetricDescriptor& metric) {
  const auto found = row.metrics.find(metric.id);
  return found == row.metrics.end() ? std::nullopt : std::optional(found->second);
}

/// The optional columns of a table.
struct Columns {
  bool sweep = false;  ///< key and value of a sweep point
  bool runs = false;   ///< number of runs of which the metrics are medians
  std::vector<TimedColumn> timed;

  /// Number of left-aligned text columns; the number columns follow.
  [[nodiscard]] std::size_t text_columns() const { return sweep ? 4 : 3; }
};

Columns columns_of(std::span<const BenchRow> rows) {
  Columns columns{.timed = present_columns(rows)};
  for (const BenchRow& row : rows) {
    columns.sweep |= !row.sweep.empty();
    columns.runs |= row.runs > 1;
  }
  return columns;
}

std::string modes_cell(const std::optional<std::size_t>& modes) {
  return modes ? fmt::format("{}", *modes) : "n/a";
}

Cells header(const Columns& columns) {
  Cells cells = {"sequence", "variant"};
  if (columns.sweep) cells.emplace_back("sweep");
  cells.emplace_back("status");
  if (columns.runs) cells.emplace_back("succeeded");
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory)) {
    cells.push_back(fmt::format("{}{}{}", metric->label, metric->unit.empty() ? "" : " ", metric->unit));
  }
  if (columns.runs) {
    cells.push_back(fmt::format("worst {} {}", headline_metric().label, headline_metric().unit));
    cells.emplace_back("modes");
  }
  for (const TimedColumn& column : columns.timed) cells.push_back(std::string(column.title) + " ms");
  return cells;
}

Cells cells_of(const BenchRow& row, const Columns& columns) {
  Cells cells = {row.sequence, row.variant};
  if (columns.sweep) cells.push_back(row.sweep);
  cells.push_back(row_status(row));
  if (columns.runs) cells.push_back(fmt::format("{} of {}", row.succeeded_runs, row.runs));
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory))
    cells.push_back(cell(metric_of(row, *metric), metric->decimals));
  if (columns.runs) {
    cells.push_back(cell(row.worst, headline_metric().decimals));
    cells.push_back(modes_cell(row.modes));
  }
  for (const TimedColumn& column : columns.timed) {
    cells.push_back(cell(row.mean_ms[static_cast<std::size_t>(column.module)], 2));
  }
  return cells;
}

/// One row of the table; text columns are left-aligned, number columns right-aligned.
std::string line(const Cells& cells, const std::vector<std::size_t>& widths, std::size_t text_columns) {
  std::string text = "|";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += i < text_columns ? fmt::format(" {:<{}} |", cells[i], widths[i])
                             : fmt::format(" {:>{}} |", cells[i], widths[i]);
  }
  return text + "\n";
}

std::string separator_line(const std::vector<std::size_t>& widths, std::size_t text_columns) {
  std::string text = "|";
  for (std::size_t i = 0; i < widths.size(); ++i) {
    text += std::string(widths[i] + 1, '-') + (i < text_columns ? "-|" : ":|");
  }
  return text + "\n";
}

Json row_json(const BenchRow& row) {
  Json timings = Json::object();
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    if (row.mean_ms[i]) timings[std::string(module_name(static_cast<Module>(i)))] = *row.mean_ms[i];
  }
  Json json = {{"sequence", row.sequence},
               {"variant", row.variant},
               {"sweep", row.sweep},
               {"status", row_status(row)},
               {"reason", row.reason},
               {"runs", row.runs},
               {"succeeded_runs", row.succeeded_runs}};
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory))
    json[std::string(metric->id)] = number_or_null(metric_of(row, *metric));
  json["worst_" + std::string(headline_metric().id)] = number_or_null(row.worst);
  json["modes_" + std::string(headline_metric().id)] = row.modes ? Json(*row.modes) : Json(nullptr);
  json["mean_ms"] = timings;
  if (!timings.empty()) json["mean_ms_note"] = time_source_note(row.time_source);
  return json;
}

/// Restriction of the times that the rows show; empty if there is none.
std::string times_note(std::span<const BenchRow> rows) {
  TimeSource worst = TimeSource::kUndisturbed;
  for (const BenchRow& row : rows) {
    const bool has_times = std::any_of(row.mean_ms.begin(), row.mean_ms.end(),
                                       [](const std::optional<double>& ms) { return ms.has_value(); });
    if (has_times) worst = std::max(worst, row.time_source);
  }
  return time_source_note(worst);
}

}  // namespace

std::string markdown_table(std::span<const BenchRow> rows) {
  const Columns columns = columns_of(rows);
  std::vector<Cells> lines = {header(columns)};
  for (const BenchRow& row : rows) lines.push_back(cells_of(row, columns));
  std::vector<std::size_t> widths(lines.front().size(), 0);
  for (const Cells& cells : lines) {
    for (std::size_t i = 0; i < cells.size(); ++i) widths[i] = std::max(widths[i], cells[i].size());
  }
  const std::size_t text_columns = columns.text_columns();
  std::string text = line(lines.front(), widths, text_columns) + separator_line(widths, text_columns);
  for (std::size_t i = 1; i < lines.size(); ++i) text += line(lines[i], widths, text_columns);
  if (const std::string note = times_note(rows); !note.empty()) text += "\nColumns in ms: " + note + "\n";
  for (const BenchRow& row : rows) {
    if (!row.reason.empty())
      text += fmt::format("\n{} {}{}{} {}: {}\n", row.sequence, row.variant, row.sweep.empty() ? "" : " ",
                          row.sweep, row_status(row), row.reason);
  }
  return text;
}

std::string json_table(const std::string& title, std::span<const BenchRow> rows) {
  Json json;
  json["schema"] = 1;
  json["title"] = title;
  json["rows"] = Json::array();
  for (const BenchRow& row : rows) json["rows"].push_back(row_json(row));
  return json.dump(2) + "\n";
}

}  // namespace stillpoint::bench
