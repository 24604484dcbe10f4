// SPDX-License-Identifier: BSD-3-Clause
/// Selection of runs for `stillpoint stats`, and its output: one table over groups of runs that may be
/// pooled.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/analysis/run_groups.h"
#include "bench/analysis/run_statistics.h"
#include "reports/tables/text_format.h"

namespace stillpoint::bench {

struct StatsArguments {
  std::string store = "build/bench/store.sqlite";
  std::string plan;
  std::string build;
  std::string metric;
  std::string base;
  std::string other;  ///< store that `stats repeat` compares with
  bool csv = false;
};

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

/// Notes, followed by those about runs that were left out.
[[nodiscard]] std::vector<std::string> with_left_out(std::vector<std::string> notes,
                                                     const RunSelection& selection);

/// `notes` with the first of the doubts, and the number of the others.
[[nodiscard]] std::vector<std::string> with_doubts(std::vector<std::string> notes,
                                                   const std::vector<std::string>& doubts);

/// Rows of one group.
struct GroupRows {
  const RunGroup* group = nullptr;
  report::TableRows rows;
};

/// Prints the rows of all groups under one header, and the notes below them. Build, machine and mode are
/// columns where they differ between groups, and always in CSV, whose notes are written to standard error.
void print_groups(const std::vector<std::string>& header, const std::vector<GroupRows>& groups,
                  const std::vector<std::string>& notes, const StatsArguments& arguments);

}  // namespace stillpoint::bench
