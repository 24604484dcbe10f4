// SPDX-License-Identifier: BSD-3-Clause
/// Format-independent table: numbers with unit, source, uncertainty and footnotes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "eval/statistics/rank_tests.h"

namespace stillpoint::report {

struct TableColumn {
  std::string group;  ///< heading above several columns, e.g. the system; may be empty
  std::string name;
  std::string unit;
  int decimals = 4;
  std::string tooltip;  ///< what the column means; may be empty
};

enum class CellState {
  kOk,
  kPartial,  ///< some of its runs failed
  kFailed,   ///< all of its runs failed
  kEmpty,    ///< no data
};

/// "ok", "partial", "failed" or "empty".
[[nodiscard]] std::string cell_state_name(CellState state);

struct TableCell {
  std::optional<double> number;  ///< absent unless kOk or kPartial
  CellState state = CellState::kEmpty;
  bool is_best = false;            ///< printed bold
  std::optional<double> coverage;  ///< median fraction of frames with a pose, of errors of a trajectory
  bool is_suspicious = false;      ///< must not be ranked or used as a target; `note` is the reason
  std::string note;                ///< footnote; equal texts share one footnote
  std::size_t count = 0;           ///< number of runs; 0 for published numbers
  std::optional<eval::Interval> interval;  ///< of the median; absent if `count` is too small for one
  std::optional<double> worst;             ///< of the runs, if there are several
  std::optional<std::size_t> modes;        ///< of the runs, see eval/statistics/modes.h
  std::vector<std::string> run_keys;       ///< keys of these runs
  std::string protocol;                    ///< evaluation protocol of the number
};

struct TableRow {
  std::string label;
  std::string source;  ///< "ours", "published" or "difference"; may be empty
  std::vector<TableCell> cells;
};

struct ReportTable {
  std::string name;  ///< base name of its files, e.g. "table2"
  std::string title;
  std::string description;  ///< what its numbers mean; may be empty
  std::string row_heading;
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;  ///< each with one cell per column
  std::vector<std::string> notes;
};

enum class TableDetail {
  kNumbers,
  kSpread,  ///< also the number of runs and the interval of the median
};

/// "n = 3", or "n = 1 to 3" if the numbers of a table have different counts.
[[nodiscard]] std::string count_text(std::size_t least, std::size_t most);

/// A cell's number of runs and its interval, printed with `decimals`: "n = 8, 0.0400 to 0.0500, worst 0.0700,
/// 2 modes" or "n = 1, no interval".
[[nodiscard]] std::string spread_text(const TableCell& cell, int decimals);

/// A cell's number as printed in every format; "failed" or "-" without a number.
[[nodiscard]] std::string number_text(const TableColumn& column, const TableCell& cell);

/// `number_text`, plus the spread if requested and available.
[[nodiscard]] std::string cell_text(const TableColumn& column, const TableCell& cell, TableDetail detail);

/// Footnotes of the cells in order of first appearance.
[[nodiscard]] std::vector<std::string> footnotes(const ReportTable& table);

/// 1, 2, ... of a cell's footnote in `notes`; 0 for none.
[[nodiscard]] std::size_t footnote_number(const std::vector<std::string>& notes, const TableCell& cell);

/// Marks the best number among `cells`; ignores cells without a number and suspicious ones, and those whose
/// coverage is more than 0.2 below the largest one, which get a footnote: an error over few poses is not
/// comparable. A mark is no statement of significance, see `best_note`.
void mark_best(const std::vector<TableCell*>& cells, bool larger_is_better);

/// Meaning of the marks of a table: "Bold: smallest median of a column, n = 1 to 3; ...".
/// @param group what the marked numbers are the best of, e.g. "column"
/// @return empty if no measured number is marked
[[nodiscard]] std::string best_note(const ReportTable& table, const std::string& group,
                                    bool larger_is_better);

}  // namespace stillpoint::report
