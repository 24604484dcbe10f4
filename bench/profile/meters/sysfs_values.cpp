// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/sysfs_values.h"

#include <algorithm>
#include <charconv>
#include <fstream>

namespace stillpoint::bench {

namespace fs = std::filesystem;

std::optional<std::string> line_in(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) return std::nullopt;
  constexpr std::string_view kBlank(" \t\r\n\0", 5);  // texts of the device tree end with a zero byte
  const std::size_t begin = line.find_first_not_of(kBlank);
  if (begin == std::string::npos) return std::nullopt;
  return line.substr(begin, line.find_last_not_of(kBlank) - begin + 1);
}

std::optional<std::int64_t> number_of(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> number_in(const fs::path& file) {
  const std::optional<std::string> line = line_in(file);
  return line ? number_of(*line) : std::nullopt;
}

std::vector<fs::path> entries_of(const fs::path& folder, std::string_view start) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().filename().string().starts_with(start)) entries.push_back(entry->path());
  }
  std::ranges::sort(entries);
  return entries;
}

}  // namespace stillpoint::bench
