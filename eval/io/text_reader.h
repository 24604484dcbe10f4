// SPDX-License-Identifier: BSD-3-Clause
/// Text file input and output: lines, numbers and exact time stamps.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/timestamp.h"

namespace stillpoint::eval {

/// Contents of a file, without a UTF-8 byte order mark at its start.
/// @throws InputError if the file cannot be read or is UTF-16 text
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Writes `text` to `file` atomically: to a temporary file that is renamed when complete.
/// @throws InputError if the file cannot be written
void write_text_file(const std::filesystem::path& file, std::string_view text);

/// Iterates over the lines of a text, which end with "\n" or "\r\n".
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// The next line without its terminator; nullopt after the last one.
  [[nodiscard]] std::optional<std::string_view> next();

  /// Number of the line returned last, starting at 1.
  [[nodiscard]] long line_number() const { return line_number_; }

 private:
  std::string_view rest_;
  long line_number_ = 0;
};

/// Parses a decimal number, "nan" or "inf"; nullopt unless the whole field is a number.
[[nodiscard]] std::optional<double> parse_number(std::string_view field);

/// Parses a decimal number of seconds; exact up to 9 decimals, rounded to the nearest nanosecond beyond.
/// @return nullopt if the field is not a finite number or the nanoseconds do not fit in 64 bits (292 years)
[[nodiscard]] std::optional<Timestamp> parse_stamp(std::string_view field);

/// Parses an integer number of nanoseconds.
[[nodiscard]] std::optional<Timestamp> parse_nanoseconds(std::string_view field);

/// Seconds with exactly 9 decimals: the inverse of `parse_stamp`.
[[nodiscard]] std::string format_stamp(Timestamp t);

}  // namespace stillpoint::eval
