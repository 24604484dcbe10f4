// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/statistics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

namespace stillpoint::eval {
namespace {

constexpr std::size_t kBuckets = 4096;
constexpr std::size_t kMinBucketed = 8 * kBuckets;  // fewer values are not divided into buckets

/// Intervals of equal width between the smallest and the largest value.
struct Buckets {
  double min;
  double per_unit;

  [[nodiscard]] std::size_t of(double value) const {
    const double position = (value - min) * per_unit;
    return position < static_cast<double>(kBuckets) ? static_cast<std::size_t>(position) : kBuckets - 1;
  }
};

/// Some of the values, among them those of given ranks, and the places that these have when sorted.
struct Candidates {
  std::vector<double> values;
  std::vector<std::size_t> places;
};

/// The values in the buckets of the ranks: of many values a small part remains.
Candidates candidates_of(std::span<const double> values, const std::vector<std::size_t>& ranks) {
  const auto [min, max] = std::ranges::minmax(values);
  if (values.size() < kMinBucketed || !std::isfinite(max - min))
    return {{values.begin(), values.end()}, ranks};
  const Buckets buckets{min, static_cast<double>(kBuckets) / (max - min)};
  std::vector<std::size_t> first(kBuckets + 1, 0);  // rank of the first value of each bucket
  for (const double value : values) ++first[buckets.of(value) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  const auto bucket_of_rank = [&](std::size_t rank) {
    return static_cast<std::size_t>(std::ranges::upper_bound(first, rank) - first.begin()) - 1;
  };
  std::vector<std::size_t> kept(kBuckets + 1, 0);  // place of the first value of each bucket
  for (const std::size_t rank : ranks) {
    const std::size_t bucket = bucket_of_rank(rank);
    kept[bucket + 1] = first[bucket + 1] - first[bucket];
  }
  std::partial_sum(kept.begin(), kept.end(), kept.begin());
  Candidates candidates;
  candidates.values.reserve(kept.back());
  for (const double value : values) {
    const std::size_t bucket = buckets.of(value);
    if (kept[bucket + 1] > kept[bucket]) candidates.values.push_back(value);
  }
  for (const std::size_t rank : ranks) {
    const std::size_t bucket = bucket_of_rank(rank);
    candidates.places.push_back(kept[bucket] + rank - first[bucket]);
  }
  return candidates;
}

/// @param fractions rising
std::vector<double> percentiles_of(std::span<const double> values, std::span<const double> fractions) {
  std::vector<std::size_t> ranks;  // two of each fraction
  std::vector<double> weights;     // of the second one
  for (const double fraction : fractions) {
    const double position = fraction * static_cast<double>(values.size() - 1);
    const auto rank = static_cast<std::size_t>(std::floor(position));
    ranks.insert(ranks.end(), {rank, std::min(rank + 1, values.size() - 1)});
    weights.push_back(position - static_cast<double>(rank));
  }
  Candidates candidates = candidates_of(values, ranks);
  std::vector<double> percentiles;
  auto begin = candidates.values.begin();  // of the largest values
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    const auto lower = candidates.values.begin() + static_cast<std::ptrdiff_t>(candidates.places[2 * i]);
    std::nth_element(begin, lower, candidates.values.end());
    begin = lower;
    const double low = *lower;
    const auto higher = std::min_element(lower + 1, candidates.values.end());
    percentiles.push_back(weights[i] == 0.0 ? low : low + weights[i] * (*higher - low));
  }
  return percentiles;
}

}  // namespace

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
  std::array<double, 1 + kPercentiles.size()> fractions{0.5};
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) fractions[i + 1] = 0.01 * kPercentiles[i];
  const std::vector<double> percentiles = percentiles_of(values, fractions);
  result.median = percentiles.front();
  std::copy(percentiles.begin() + 1, percentiles.end(), result.percentiles.begin());
  return result;
}

std::optional<double> percentile(std::span<const double> values, double fraction) {
  if (values.empty()) return std::nullopt;
  const std::array<double, 1> fractions{std::clamp(fraction, 0.0, 1.0)};
  return percentiles_of(values, fractions).front();
}

}  // namespace stillpoint::eval
