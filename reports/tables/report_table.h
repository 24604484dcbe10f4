// SPDX-License-Identifier: BSD-3-Clause
/// A table of numbers before it has a format: what each number is, where it comes from, what is odd about it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "eval/statistics/bootstrap.h"

namespace stillpoint {

struct TableColumn {
  std::string group;  ///< heading over several columns, e.g. the system; may be empty
  std::string name;
  std::string unit;
  int decimals = 4;
};

enum class CellState {
  kOk,
  kPartial,  ///< some of its runs did not end well
  kFailed,   ///< all of its runs did not end well
  kEmpty,    ///< there is nothing to say
};

/// "ok", "partial", "failed" or "empty".
[[nodiscard]] std::string cell_state_name(CellState state);

struct TableCell {
  std::optional<double> number;  ///< absent unless kOk or kPartial
  CellState state = CellState::kEmpty;
  bool is_best = false;        ///< printed bold
  bool is_suspicious = false;  ///< a quoted number that is not to be used as a target
  std::string note;            ///< footnote; the same text is printed once
  std::size_t count = 0;       ///< runs behind the number; 0 for quoted ones
  std::optional<Interval> interval;
  std::vector<std::string> run_keys;  ///< of these runs
  std::string recipe;                 ///< how the number was made
};

struct TableRow {
  std::string label;
  std::string from;  ///< "ours", "published" or "difference"; may be empty
  std::vector<TableCell> cells;
};

struct ReportTable {
  std::string name;  ///< of its files, e.g. "table2"
  std::string title;
  std::string row_heading;
  std::vector<TableColumn> columns;
  std::vector<TableRow> rows;  ///< each with a cell for every column
  std::vector<std::string> notes;
};

enum class TableDetail {
  kNumbers,
  kSpread,  ///< also the number of runs and the interval of the median
};

/// A cell's number as every format prints it; "failed" or "-" where there is none.
[[nodiscard]] std::string number_text(const TableColumn& column, const TableCell& cell);

/// `number_text`, and the spread where it is asked for and known.
[[nodiscard]] std::string cell_text(const TableColumn& column, const TableCell& cell, TableDetail detail);

/// Footnotes of the cells in order of first appearance.
[[nodiscard]] std::vector<std::string> footnotes(const ReportTable& table);

/// 1, 2, ... of a cell's footnote in `notes`; 0 for none.
[[nodiscard]] std::size_t footnote_number(const std::vector<std::string>& notes, const TableCell& cell);

/// Marks the best number of each list of cells; cells without a number and suspicious ones are not counted.
void mark_best(const std::vector<TableCell*>& cells, bool larger_is_better);

}  // namespace stillpoint
