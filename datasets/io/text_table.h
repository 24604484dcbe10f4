// SPDX-License-Identifier: BSD-3-Clause
/// Text files with one record per line: fields separated by whitespace or commas, `#` starts a comment line,
/// errors name the line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/io/fault_log.h"

namespace stillpoint::datasets {

/// Parses a decimal number of seconds, such as "1311868164.363181" or "1.3e9", exactly (not through a
/// double); digits below the nanosecond are rounded half up.
/// @return nothing if `text` is not a decimal number or is beyond +-292 years
[[nodiscard]] std::optional<Timestamp> parse_seconds(std::string_view text);

/// One record and its line number, counted from 1.
struct TextRow {
  long line = 0;
  std::vector<std::string> fields;
};

/// A text file read into memory.
class TextTable {
 public:
  /// @throws InputError if the file is missing or unreadable
  explicit TextTable(const std::filesystem::path& file);

  [[nodiscard]] const std::vector<TextRow>& rows() const { return rows_; }

  /// Visits all rows in order; an InputError thrown by `visit` is handled by `faults`.
  template <class Visit>
  void for_each(FaultLog& faults, Visit&& visit) const {
    for (const TextRow& row : rows_) {
      faults.guard([&] { visit(row); });
    }
  }

  /// Each of the following throws an InputError that names file and line if the field is missing or invalid.
  [[nodiscard]] const std::string& text(const TextRow& row, std::size_t field) const;
  [[nodiscard]] double number(const TextRow& row, std::size_t field) const;  ///< finite
  [[nodiscard]] Timestamp seconds(const TextRow& row, std::size_t field) const;
  [[nodiscard]] Timestamp nanoseconds(const TextRow& row, std::size_t field) const;  ///< an integer

  /// @throws InputError unless `now` is later than `previous`
  void require_increasing(const TextRow& row, Timestamp previous, Timestamp now) const;

  [[noreturn]] void fail(const TextRow& row, const std::string& problem) const;
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  std::string file_;
  std::vector<TextRow> rows_;
};

}  // namespace stillpoint::datasets
