// SPDX-License-Identifier: BSD-3-Clause
/// Text files of one record a line: fields split at blanks and commas, `#` lines are comments, errors name
/// the line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/timestamp.h"
#include "datasets/fault_log.h"

namespace stillpoint {

/// Nanoseconds of a decimal number of seconds, such as "1311868164.363181" or "1.3e9", without passing
/// through a double; digits below the nanosecond are rounded half up.
/// @return nothing if `text` is no decimal number or beyond +-292 years
[[nodiscard]] std::optional<Timestamp> parse_seconds(std::string_view text);

/// One record and the line it stood on, counted from 1.
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

  /// Visits every row in order; an InputError of a visit goes to `faults`.
  template <class Visit>
  void for_each(FaultLog& faults, Visit&& visit) const {
    for (const TextRow& row : rows_) {
      faults.guard([&] { visit(row); });
    }
  }

  /// Each of the following throws an InputError that names file and line when the field is missing or unfit.
  [[nodiscard]] const std::string& text(const TextRow& row, std::size_t field) const;
  [[nodiscard]] double number(const TextRow& row, std::size_t field) const;  ///< finite
  [[nodiscard]] Timestamp seconds(const TextRow& row, std::size_t field) const;
  [[nodiscard]] Timestamp nanoseconds(const TextRow& row, std::size_t field) const;  ///< a whole number

  /// @throws InputError unless `now` lies after `previous`
  void require_rising(const TextRow& row, Timestamp previous, Timestamp now) const;

  [[noreturn]] void fail(const TextRow& row, const std::string& problem) const;
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  std::string file_;
  std::vector<TextRow> rows_;
};

}  // namespace stillpoint
