// SPDX-License-Identifier: BSD-3-Clause
/// Parses lines of a store's CSV files; error messages contain file and line.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace stillpoint::bench {

/// Columns x, y, z, qx, qy, qz, qw.
inline constexpr int kPoseColumns = 7;

/// Cuts the part before `separator` off the front of `text`.
inline std::string_view cut_front(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return part;
}

/// Parser state: the position for error messages.
struct CsvRows {
  const std::string& place;
  std::string_view header;  ///< expected first line
  long line = 1;

  /// @throws InputError unless `text` is an integer
  [[nodiscard]] std::int64_t number(std::string_view text) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size()) return value;
    const std::string problem = "\"" + std::string(text) + "\" is not an integer";
    throw InputError(place, line, problem + "; expected columns: " + std::string(header));
  }

  /// @throws InputError unless `text` is a number
  [[nodiscard]] double real(std::string_view text) const {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size()) return value;
    throw InputError(place, line, "'" + std::string(text) + "' is not a number");
  }

  /// Calls `take` with every row after the header line.
  /// @throws InputError if the first line is not the header
  template <class Take>
  void for_each_row(std::string_view text, Take&& take) {
    if (cut_front(text, '\n') != header)
      throw InputError(place, line, "does not begin with " + std::string(header));
    while (!text.empty()) {
      const std::string_view row = cut_front(text, '\n');
      ++line;
      if (!row.empty()) take(row);
    }
  }
};

}  // namespace stillpoint::bench
