// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stillpoint::eval {

std::optional<Statistics> statistics(std::span<const double> values) {
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
  result.median = *percentile(values, 0.5);
  return result;
}

std::optional<double> percentile(std::span<const double> values, double fraction) {
  if (values.empty()) return std::nullopt;
  std::vector<double> reordered(values.begin(), values.end());
  const double rank = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(reordered.size() - 1);
  const auto lower = reordered.begin() + static_cast<std::ptrdiff_t>(std::floor(rank));
  std::nth_element(reordered.begin(), lower, reordered.end());
  const double low = *lower;
  const double weight = rank - std::floor(rank);
  if (weight == 0.0) return low;
  const double high = *std::min_element(lower + 1, reordered.end());
  return low + weight * (high - low);
}

}  // namespace stillpoint::eval
