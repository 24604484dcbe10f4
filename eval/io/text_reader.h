// SPDX-License-Identifier: BSD-3-Clause
/// Text files: whole files, lines, exact numbers and time stamps, and tables with one record per line, whose
/// fields are separated by spaces, tabs, commas or semicolons; `#` starts a comment line. Two commas without
/// a value between them enclose an empty field. Errors name file and line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/timestamp.h"

namespace stillpoint::eval {

/// Contents of a file, without a UTF-8 byte order mark at its start.
/// @throws InputError if the file cannot be read or is UTF-16 text
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file);

/// Writes `text` to `file` atomically: to a temporary file that is renamed when complete.
/// @throws InputError if the file cannot be written
void write_text_file(const std::filesystem::path& file, std::string_view text);

/// A text file in blocks of whole lines, so that it needs not fit in memory.
class TextBlocks {
 public:
  /// Reads the first block: at least two records (a header and a row), or the whole file.
  /// @throws InputError as `read_text_file`, or if the file is binary or compressed
  explicit TextBlocks(const std::filesystem::path& file);

  /// The current block, which `advance` invalidates; empty behind the end of the file.
  [[nodiscard]] std::string_view block() const {
    return std::string_view(buffer_).substr(begin_, end_ - begin_);
  }

  /// Number of lines of the file, as far as the current block tells it, and rather too large; at most one per
  /// 32 bytes.
  [[nodiscard]] std::size_t estimated_lines() const;

  /// Reads the next block.
  /// @throws InputError if the file cannot be read
  void advance();

 private:
  void read_more();

  std::string name_;
  std::ifstream stream_;
  std::uint64_t unread_ = 0;  ///< bytes of the file behind the buffer
  std::string buffer_;
  std::size_t begin_ = 0;  ///< of the current block in the buffer
  std::size_t end_ = 0;
};

/// Iterates over the lines of a text, which end with "\n" or "\r\n".
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}

  /// Reads a file from its current block on; a line is valid until the next one is read.
  explicit LineReader(TextBlocks& blocks) : blocks_(&blocks), rest_(blocks.block()) {}

  /// The next line without its terminator; nullopt after the last one.
  [[nodiscard]] std::optional<std::string_view> next();

  /// Number of the line returned last, starting at 1.
  [[nodiscard]] long line_number() const { return line_number_; }

 private:
  TextBlocks* blocks_ = nullptr;
  std::string_view rest_;
  long line_number_ = 0;
};

/// Parses a decimal number, "nan" or "inf"; nullopt unless the whole field is a number.
[[nodiscard]] std::optional<double> parse_number(std::string_view field);

/// Parses a decimal number of seconds; exact up to 9 decimals, rounded to the nearest nanosecond beyond.
/// @return nullopt if the field is not a finite number or the nanoseconds do not fit in 64 bits (292 years)
[[nodiscard]] std::optional<Timestamp> parse_stamp(std::string_view field);

/// Parses an integer number of nanoseconds, also with decimals that are 0 ("1403636579763555584.000000").
[[nodiscard]] std::optional<Timestamp> parse_nanoseconds(std::string_view field);

/// Seconds with exactly 9 decimals: the inverse of `parse_stamp`.
[[nodiscard]] std::string format_stamp(Timestamp t);

enum class TimeUnit { kSeconds, kNanoseconds };

/// One record; valid until its reader advances. The accessors throw an InputError with file and line if the
/// field is missing, empty or invalid.
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
  RowReader(TextBlocks& blocks, std::string_view file) : lines_(blocks), file_(file) {}

  /// The next record; nullopt after the last one.
  /// @throws InputError if lines end with carriage returns only, or the file is binary or compressed
  [[nodiscard]] std::optional<TextRow> next();

 private:
  LineReader lines_;
  std::string_view file_;
  std::vector<std::string_view> fields_;  ///< of the current row; the storage is reused
};

/// Calls `visit(row)` for each record; an InputError that it throws is handled by `faults`.
template <class Visit>
void for_each_row(RowReader rows, FaultLog& faults, const Visit& visit) {
  while (const std::optional<TextRow> row = rows.next()) {
    faults.guard([&] { visit(*row); });
  }
}

/// The same for a text in memory.
template <class Visit>
void for_each_row(std::string_view text, std::string_view file, FaultLog& faults, const Visit& visit) {
  for_each_row(RowReader(text, file), faults, visit);
}

}  // namespace stillpoint::eval
