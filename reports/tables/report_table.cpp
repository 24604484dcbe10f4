// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/report_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "bench/model/run_notes.h"

namespace stillpoint::report {

std::string cell_state_name(CellState state) {
  switch (state) {
    case CellState::kOk:
      return "ok";
    case CellState::kPartial:
      return "partial";
    case CellState::kFailed:
      return "failed";
    case CellState::kEmpty:
      return "empty";
  }
  return "";
}

std::string count_text(std::size_t least, std::size_t most) {
  return least == most ? fmt::format("n = {}", least) : fmt::format("n = {} to {}", least, most);
}

std::string spread_text(const TableCell& cell, int decimals) {
  const std::string count = count_text(cell.count, cell.count);
  const std::string interval = cell.interval ? fmt::format(", {:.{}f} to {:.{}f}", cell.interval->low,
                                                           decimals, cell.interval->high, decimals)
                                             : ", no interval";
  const std::string worst = cell.worst ? fmt::format(", worst {:.{}f}", *cell.worst, decimals) : "";
  return count + interval + worst +
         (cell.modes.value_or(1) > 1 ? fmt::format(", {} modes", *cell.modes) : "");
}

std::string number_text(const TableColumn& column, const TableCell& cell) {
  if (cell.number) return fmt::format("{:.{}f}", *cell.number, column.decimals);
  return cell.state == CellState::kFailed ? "failed" : "-";
}

std::string cell_text(const TableColumn& column, const TableCell& cell, TableDetail detail) {
  std::string number = number_text(column, cell);
  if (detail == TableDetail::kNumbers || cell.count == 0 || !cell.number) return number;
  return number + " (" + spread_text(cell, column.decimals) + ")";
}

std::vector<std::string> footnotes(const ReportTable& table) {
  std::vector<std::string> notes;
  for (const TableRow& row : table.rows) {
    for (const TableCell& cell : row.cells) {
      const bool is_known = std::find(notes.begin(), notes.end(), cell.note) != notes.end();
      if (!cell.note.empty() && !is_known) notes.push_back(cell.note);
    }
  }
  return notes;
}

std::size_t footnote_number(const std::vector<std::string>& notes, const TableCell& cell) {
  if (cell.note.empty()) return 0;
  const auto found = std::find(notes.begin(), notes.end(), cell.note);
  return found == notes.end() ? 0 : static_cast<std::size_t>(found - notes.begin()) + 1;
}

void mark_best(const std::vector<TableCell*>& cells, bool larger_is_better) {
  double coverage = 0.0;
  for (const TableCell* cell : cells) {
    if (cell->number) coverage = std::max(coverage, cell->coverage.value_or(0.0));
  }
  const auto covers_less = [&](const TableCell& cell) {
    return cell.number && cell.coverage && *cell.coverage < coverage - bench::kMaxCoverageGap;
  };
  for (TableCell* cell : cells) {
    if (!covers_less(*cell)) continue;
    cell->note += (cell->note.empty() ? "" : "; ") +
                  fmt::format("coverage {:.2f}, others {:.2f}: not ranked", *cell->coverage, coverage);
  }
  std::optional<double> best;
  const auto counts = [&](const TableCell& cell) {
    return cell.number && !cell.is_suspicious && !covers_less(cell);
  };
  for (const TableCell* cell : cells) {
    if (!counts(*cell)) continue;
    if (!best || (larger_is_better ? *cell->number > *best : *cell->number < *best)) best = cell->number;
  }
  for (TableCell* cell : cells) cell->is_best = counts(*cell) && cell->number == best;
}

std::string best_note(const ReportTable& table, const std::string& group, bool larger_is_better) {
  std::vector<std::size_t> counts;
  bool is_marked = false;
  for (const TableRow& row : table.rows) {
    for (const TableCell& cell : row.cells) {
      if (cell.number && cell.count > 0) counts.push_back(cell.count);
      is_marked |= cell.is_best && cell.count > 0;
    }
  }
  if (!is_marked) return "";
  const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
  return fmt::format("Bold: {} median of a {}, {}; not a statement of significance.",
                     larger_is_better ? "largest" : "smallest", group, count_text(*least, *most));
}

}  // namespace stillpoint::report
