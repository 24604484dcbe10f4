// SPDX-License-Identifier: BSD-3-Clause
/// Text files taken apart into lines and fields, with exact time stamps.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/timestamp.h"

namespace stillpoint {

/// A whole file as one string.
/// @throws InputError if the file cannot be read
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Writes `text` to `file`, whole or not at all: a file of another name is renamed when it is complete.
/// @throws InputError if the file cannot be written
void write_text_file(const std::filesystem::path& file, std::string_view text);

/// Walks over the lines of a text; "\n" and "\r\n" both end a line.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// The next line without its end, or nothing after the last one.
  [[nodiscard]] std::optional<std::string_view> next();

  /// Number of the line returned last, counted from 1.
  [[nodiscard]] long line_number() const { return line_number_; }

 private:
  std::string_view rest_;
  long line_number_ = 0;
};

/// Splits a line at spaces, tabs and commas into `fields`, whose storage is used again from line to line.
void split_fields(std::string_view line, std::vector<std::string_view>& fields);

/// A decimal number, whole field; "nan" and "inf" are numbers too.
[[nodiscard]] std::optional<double> parse_number(std::string_view field);

/// A decimal number of seconds as nanoseconds: exact up to 9 decimals, rounded to nearest beyond. Nothing if
/// the field is no finite number or the stamp does not fit 64 bits (292 years).
[[nodiscard]] std::optional<Timestamp> parse_stamp(std::string_view field);

/// A whole number of nanoseconds.
[[nodiscard]] std::optional<Timestamp> parse_nanoseconds(std::string_view field);

/// Seconds with exactly 9 decimals: the inverse of `parse_stamp`.
[[nodiscard]] std::string format_stamp(Timestamp t);

}  // namespace stillpoint
