// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/spelling.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace stillpoint::bench {
namespace {

constexpr double kWrongLetter = 1.0;
constexpr double kOmittedLetter = 0.1;
constexpr double kSwappedLetters = 0.2;

/// Whether the text is the path of a file or folder, for which a name would be no remedy.
bool is_file_path(std::string_view typed) {
  return typed.starts_with('/') || typed.starts_with("./") || typed.starts_with("../") ||
         typed.starts_with('~');
}

/// Whether at most half of the typed letters are wrong.
bool resembles(std::string_view typed, std::string_view name) {
  const double omitted = name.size() > typed.size() ? static_cast<double>(name.size() - typed.size()) : 0.0;
  const double wrong = spelling_distance(typed, name) - kOmittedLetter * omitted;
  return wrong <= 0.5 * kWrongLetter * static_cast<double>(typed.size());
}

}  // namespace

double spelling_distance(std::string_view typed, std::string_view name) {
  // Row i of the matrix of Damerau and Levenshtein: cost of transforming the first i typed letters into each
  // prefix of the name.
  std::vector<double> row(name.size() + 1);
  for (std::size_t j = 0; j <= name.size(); ++j) row[j] = kOmittedLetter * static_cast<double>(j);
  std::vector<double> last, before_last;
  for (std::size_t i = 1; i <= typed.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] += kWrongLetter;
    for (std::size_t j = 1; j <= name.size(); ++j) {
      const double replaced = last[j - 1] + (typed[i - 1] == name[j - 1] ? 0.0 : kWrongLetter);
      row[j] = std::min({replaced, last[j] + kWrongLetter, row[j - 1] + kOmittedLetter});
      if (i > 1 && j > 1 && typed[i - 1] == name[j - 2] && typed[i - 2] == name[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + kSwappedLetters);
    }
  }
  return row[name.size()];
}

std::string suggestion(std::string_view typed, std::span<const std::string> names) {
  if (is_file_path(typed)) return "";
  const auto nearest = std::min_element(names.begin(), names.end(), [&](const auto& a, const auto& b) {
    return spelling_distance(typed, a) < spelling_distance(typed, b);
  });
  if (nearest == names.end() || !resembles(typed, *nearest)) return "";
  return "; did you mean \"" + *nearest + "\"?";
}

}  // namespace stillpoint::bench
