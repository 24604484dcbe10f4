// SPDX-License-Identifier: BSD-3-Clause
/// Tables for programs: named columns of typed values, as CSV and as JSON. bench/schemas has a schema for
/// each kind.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace stillpoint::report {

/// Without a value: no data.
using DataValue = std::variant<std::monostate, bool, std::int64_t, double, std::string>;
using DataRow = std::vector<DataValue>;

struct DataTable {
  std::string kind;                  ///< name of the schema, e.g. "stats_summary"
  std::vector<std::string> columns;  ///< different; the unit is the end of the name, unless it is a column
  std::vector<DataRow> rows;         ///< one value per column
  std::vector<std::string> notes;    ///< sentences for readers
  int version = 1;                   ///< of the schema
};

/// Help of the option --json of commands that print a table.
inline constexpr const char* kJsonHelp = "Print JSON with full precision; see bench/README.md, \"Schemas\"";

[[nodiscard]] DataValue data_value(std::size_t count);
[[nodiscard]] DataValue data_value(const std::optional<double>& value);
/// No data if the text is empty.
[[nodiscard]] DataValue data_value(const std::string& text);

/// RFC 4180 with a header; numbers with all digits ("inf" and "nan" for values that are none), "true" and
/// "false", empty cells without data. Notes are left out.
[[nodiscard]] std::string data_csv(const DataTable& table);

/// The rows of `data_csv`.
[[nodiscard]] std::string data_rows_csv(const std::vector<DataRow>& rows);

/// An object with the members kind, schema (the version), rows (objects with a member per column) and notes.
/// Null stands for no data and for numbers that are not finite.
[[nodiscard]] std::string data_json(const DataTable& table);

}  // namespace stillpoint::report
