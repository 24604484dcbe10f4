// SPDX-License-Identifier: BSD-3-Clause
/// Text tables: one record per line, fields separated by spaces, tabs or commas, `#` starts a comment line.
/// Errors name file and line.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/timestamp.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {

enum class TimeUnit { kSeconds, kNanoseconds };

/// One record; valid until its reader advances. The accessors throw an InputError with file and line if the
/// field is missing or invalid.
struct TextRow {
  std::string_view file;  ///< name, for messages
  long line = 0;          ///< counted from 1
  std::string_view content;
  std::span<const std::string_view> fields;

  [[nodiscard]] std::string_view text(std::size_t field) const;
  [[nodiscard]] double number(std::size_t field) const;         ///< may be NaN or infinite
  [[nodiscard]] double finite_number(std::size_t field) const;  ///< rejects NaN and infinity
  [[nodiscard]] Timestamp time(std::size_t field, TimeUnit unit) const;

  /// @throws InputError unless `now` is later than `previous`, the time of the previous row
  void require_increasing(Timestamp previous, Timestamp now) const;

  [[nodiscard]] InputError error(const std::string& problem) const;
};

/// Iterates over the records of a text; skips blank lines and comments.
class RowReader {
 public:
  /// @param text contents of the file
  /// @param file its name, for messages; both arguments must outlive the reader and its rows
  RowReader(std::string_view text, std::string_view file) : lines_(text), file_(file) {}

  /// The next record; nullopt after the last one.
  [[nodiscard]] std::optional<TextRow> next();

 private:
  LineReader lines_;
  std::string_view file_;
  std::vector<std::string_view> fields_;  ///< of the current row; the storage is reused
};

/// Calls `visit(row)` for each record of a text; an InputError that it throws is handled by `faults`.
template <class Visit>
void for_each_row(std::string_view text, std::string_view file, FaultLog& faults, const Visit& visit) {
  RowReader rows(text, file);
  while (const std::optional<TextRow> row = rows.next()) {
    faults.guard([&] { visit(*row); });
  }
}

}  // namespace stillpoint::eval
