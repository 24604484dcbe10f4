// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stillpoint::eval {

std::optional<Statistics> statistics(std::span<const double> values) {
  std::vector<double> copy(values.begin(), values.end());
  return reordering_statistics(copy);
}

std::optional<Statistics> reordering_statistics(std::span<double> values) {
  if (values.empty()) return std::nullopt;
  Statistics result{.count = values.size(), .min = values.front(), .max = values.front()};
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
    result.sse += value * value;
    result.min = std::min(result.min, value);
    result.max = std::max(result.max, value);
  }
  const double count = static_cast<double>(values.size());
  result.mean = sum / count;
  result.rmse = std::sqrt(result.sse / count);
  double squared_deviation = 0.0;
  for (const double value : values) squared_deviation += (value - result.mean) * (value - result.mean);
  result.std = std::sqrt(squared_deviation / count);
  result.median = *reordering_percentile(values, 0.5);
  return result;
}

std::optional<double> percentile(std::span<const double> values, double fraction) {
  std::vector<double> copy(values.begin(), values.end());
  return reordering_percentile(copy, fraction);
}

std::optional<double> reordering_percentile(std::span<double> values, double fraction) {
  if (values.empty()) return std::nullopt;
  const double rank = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto lower = values.begin() + static_cast<std::ptrdiff_t>(std::floor(rank));
  std::nth_element(values.begin(), lower, values.end());
  const double low = *lower;
  const double weight = rank - std::floor(rank);
  if (weight == 0.0) return low;
  const double high = *std::min_element(lower + 1, values.end());
  return low + weight * (high - low);
}

}  // namespace stillpoint::eval
