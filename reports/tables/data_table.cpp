// SPDX-License-Identifier: BSD-3-Clause
#include "reports/tables/data_table.h"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "reports/tables/text_format.h"

namespace stillpoint::report {
namespace {

struct CsvText {
  std::string operator()(std::monostate) const { return ""; }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return fmt::format("{}", value); }
  std::string operator()(const std::string& text) const { return csv_field(text); }
};

struct JsonValue {
  nlohmann::ordered_json operator()(std::monostate) const { return nullptr; }
  nlohmann::ordered_json operator()(double value) const {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nullptr;
  }
  nlohmann::ordered_json operator()(const std::string& text) const { return clean_line(text); }
  template <class Value>
  nlohmann::ordered_json operator()(Value value) const {
    return value;
  }
};

}  // namespace

DataValue data_value(std::size_t count) { return static_cast<std::int64_t>(count); }

DataValue data_value(const std::optional<double>& value) { return value ? DataValue(*value) : DataValue(); }

DataValue data_value(const std::string& text) { return text.empty() ? DataValue() : DataValue(text); }

std::string data_csv(const DataTable& table) {
  return fmt::format("{}\n", fmt::join(table.columns, ",")) + data_rows_csv(table.rows);
}

std::string data_rows_csv(const std::vector<DataRow>& rows) {
  std::string text;
  for (const DataRow& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i > 0 ? "," : "") + std::visit(CsvText{}, row[i]);
    text += '\n';
  }
  return text;
}

std::string data_json(const DataTable& table) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const DataRow& row : table.rows) {
    STILLPOINT_CHECK(row.size() == table.columns.size());
    nlohmann::ordered_json members = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < row.size(); ++i) members[table.columns[i]] = std::visit(JsonValue{}, row[i]);
    rows.push_back(std::move(members));
  }
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  for (const std::string& note : table.notes) notes.push_back(clean_line(note));
  const nlohmann::ordered_json document = {{"kind", table.kind},
                                           {"schema", table.version},
                                           {"rows", std::move(rows)},
                                           {"notes", std::move(notes)}};
  return document.dump(2) + "\n";
}

}  // namespace stillpoint::report
