// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stillpoint::eval {
namespace {

std::size_t rank_below(std::size_t count, double fraction) {
  return static_cast<std::size_t>(std::floor(fraction * static_cast<double>(count - 1)));
}

/// @param values of which those from `begin` on are the largest; reordered so from the rank of `fraction` on
double percentile_above(std::span<double> values, std::size_t begin, double fraction) {
  const std::size_t rank = rank_below(values.size(), fraction);
  const auto lower = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin() + static_cast<std::ptrdiff_t>(begin), lower, values.end());
  const double low = *lower;
  const double weight = fraction * static_cast<double>(values.size() - 1) - static_cast<double>(rank);
  if (weight == 0.0) return low;
  const double high = *std::min_element(lower + 1, values.end());
  return low + weight * (high - low);
}

}  // namespace

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
  std::size_t begin = 0;
  const auto next_percentile = [&](double fraction) {
    const double value = percentile_above(values, begin, fraction);
    begin = rank_below(values.size(), fraction);
    return value;
  };
  result.median = next_percentile(0.5);
  for (std::size_t i = 0; i < kPercentiles.size(); ++i)
    result.percentiles[i] = next_percentile(0.01 * kPercentiles[i]);
  return result;
}

std::optional<double> percentile(std::span<const double> values, double fraction) {
  std::vector<double> copy(values.begin(), values.end());
  return reordering_percentile(copy, fraction);
}

std::optional<double> reordering_percentile(std::span<double> values, double fraction) {
  if (values.empty()) return std::nullopt;
  return percentile_above(values, 0, std::clamp(fraction, 0.0, 1.0));
}

}  // namespace stillpoint::eval
