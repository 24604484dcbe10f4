// SPDX-License-Identifier: BSD-3-Clause
/// Selection of runs for `stillpoint stats`, and its output: one table over groups of runs that may be
/// pooled, for readers or for programs.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/analysis/run_groups.h"
#include "bench/analysis/run_statistics.h"
#include "core/base/fields.h"
#include "reports/tables/data_table.h"
#include "reports/tables/text_format.h"

namespace stillpoint::bench {

enum class StatsFormat { kTable, kCsv, kJson };
constexpr auto enum_names(StatsFormat) {
  return EnumNames<StatsFormat, 3>{
      {{StatsFormat::kTable, "table"}, {StatsFormat::kCsv, "csv"}, {StatsFormat::kJson, "json"}}};
}

struct StatsArguments {
  std::string store = "build/bench/store.sqlite";
  std::string plan;
  std::string build;
  std::string metric;
  std::string base;
  std::string other;  ///< store that `stats repeat` compares with
  std::string format_name = "table";
  StatsFormat format = StatsFormat::kTable;  ///< of `format_name`
};

/// The arguments with the plan of a statistic, unless they name another one.
/// @param plan name of a plan with faults
/// @throws InputError if the store has no plan of this name
[[nodiscard]] StatsArguments with_default_plan(const Store& store, StatsArguments arguments,
                                               const std::string& plan);

/// The runs that the arguments select, in groups.
/// @throws InputError if there is none, for an unknown plan or build
[[nodiscard]] RunSelection chosen_runs(const Store& store, const StatsArguments& arguments);

/// @throws InputError if no run has the metric; the message lists those that exist, the nearest first
void require_metric(const RunSelection& selection, const std::string& metric);

/// Five significant digits.
[[nodiscard]] std::string number_cell(double value);

/// "1.2 to 1.4", or "- (n = 3)" without an interval.
[[nodiscard]] std::string interval_cell(const std::optional<eval::Interval>& interval, std::size_t count);

/// Sentence about the intervals of a table: their test, the smallest n that supports them, and the smallest
/// p-value that can be reached by rows below it.
/// @param test   e.g. "exact signed-rank test"
/// @param counts n of the rows
[[nodiscard]] std::string interval_note(const std::string& test, const std::set<std::size_t>& counts);

/// Sentence about runs or pairs that count once.
/// @param what "run" or "pair"
[[nodiscard]] std::string copies_note(std::size_t copies, const char* what);

/// Sentence about runs or pairs without a value.
/// @param what with their number
[[nodiscard]] std::string without_value_note(const std::string& what);

/// Notes, followed by those about runs that were left out.
[[nodiscard]] std::vector<std::string> with_left_out(std::vector<std::string> notes,
                                                     const RunSelection& selection);

/// What distinguishes a group from others, such as "machine A, 4 processors: "; empty if there is only one.
[[nodiscard]] std::string group_prefix(const RunSelection& selection, const RunGroup& group);

/// `notes` with the first of the doubts, and the number of the others.
[[nodiscard]] std::vector<std::string> with_doubts(std::vector<std::string> notes,
                                                   const std::vector<std::string>& doubts);

/// Unit of a metric, as its runs state it; empty for ratios and counts.
[[nodiscard]] std::string metric_unit(const RunSelection& selection, const std::string& metric);

/// Low and high end; no data without an interval.
[[nodiscard]] report::DataRow interval_values(const std::optional<eval::Interval>& interval);

/// Rows of one group.
struct GroupRows {
  const RunGroup* group = nullptr;
  report::TableRows rows;             ///< for readers
  std::vector<report::DataRow> data;  ///< for programs; need not be one for each of `rows`
};

/// The rows of all groups under one header. Build, machine and mode are columns of their own.
struct StatsTable {
  std::vector<std::string> header;   ///< of `GroupRows::rows`
  std::string kind;                  ///< of the table for programs, see `report::DataTable`
  std::vector<std::string> columns;  ///< of `GroupRows::data`
  std::vector<GroupRows> groups;     ///< at least one
  std::vector<std::string> notes;
  int version = 1;  ///< of the schema
};

/// Prints a table with the notes below it. For readers, build, machine and mode are columns where they differ
/// between groups. For programs, they always are; notes of CSV are written to standard error.
void print_stats(const StatsTable& table, const StatsArguments& arguments);

}  // namespace stillpoint::bench
