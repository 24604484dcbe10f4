// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "reports/tables/escaping.h"
#include "reports/tables/formats/table_formats.h"

namespace stillpoint::report {
namespace {

using Json = nlohmann::ordered_json;

Json cell_json(const TableColumn& column, const TableCell& cell) {
  Json json;
  json["state"] = cell_state_name(cell.state);
  // The number as printed, so that the file and the page agree.
  json["value"] = cell.number ? Json::parse(number_text(column, cell)) : Json(nullptr);
  json["exact"] = cell.number ? Json(*cell.number) : Json(nullptr);
  json["n"] = cell.count;
  json["interval"] = cell.interval ? Json({cell.interval->low, cell.interval->high}) : Json(nullptr);
  json["best"] = cell.is_best;
  if (cell.is_suspicious) json["suspicious"] = true;
  if (!cell.note.empty()) json["note"] = clean_line(cell.note);
  if (!cell.protocol.empty()) json["protocol"] = clean_line(cell.protocol);
  json["runs"] = cell.run_keys;
  return json;
}

}  // namespace

std::string table_csv(const ReportTable& table) {
  std::string text = "row,source,group,column,unit,value,n,low,high,state,note\n";
  for (const TableRow& row : table.rows) {
    for (std::size_t i = 0; i < row.cells.size(); ++i) {
      const TableColumn& column = table.columns[i];
      const TableCell& cell = row.cells[i];
      const std::string number = cell.number ? number_text(column, cell) : "";
      const auto limit = [&](double value) { return fmt::format("{:.{}f}", value, column.decimals); };
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(row.label), csv_field(row.source),
                          csv_field(column.group), csv_field(column.name), csv_field(column.unit), number,
                          cell.count, cell.interval ? limit(cell.interval->low) : "",
                          cell.interval ? limit(cell.interval->high) : "", cell_state_name(cell.state),
                          csv_field(cell.note));
    }
  }
  return text;
}

Json table_json(const ReportTable& table) {
  Json json;
  json["name"] = table.name;
  json["title"] = clean_line(table.title);
  json["row_heading"] = clean_line(table.row_heading);
  json["columns"] = Json::array();
  for (const TableColumn& column : table.columns) {
    json["columns"].push_back({{"group", clean_line(column.group)},
                               {"name", clean_line(column.name)},
                               {"unit", clean_line(column.unit)}});
  }
  json["rows"] = Json::array();
  for (const TableRow& row : table.rows) {
    Json cells = Json::array();
    for (std::size_t i = 0; i < row.cells.size(); ++i)
      cells.push_back(cell_json(table.columns[i], row.cells[i]));
    json["rows"].push_back(
        {{"label", clean_line(row.label)}, {"source", clean_line(row.source)}, {"cells", cells}});
  }
  json["notes"] = Json::array();
  for (const std::string& note : table.notes) json["notes"].push_back(clean_line(note));
  return json;
}

}  // namespace stillpoint::report
