// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/median_interval.h"

#include <algorithm>
#include <vector>

#include "eval/metrics/statistics.h"

namespace stillpoint::eval {

std::optional<Interval> median_interval(std::span<const double> values, double confidence) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const std::vector<std::size_t> ranks(sorted.size(), 1);
  return interval_of_candidates(sorted, sign_distribution(ranks), confidence);
}

std::optional<Spread> spread(std::span<const double> values, double confidence) {
  if (values.empty()) return std::nullopt;
  return Spread{.count = values.size(),
                .median = *percentile(values, 0.5),
                .quartiles = {.low = *percentile(values, 0.25), .high = *percentile(values, 0.75)},
                .worst = *std::max_element(values.begin(), values.end()),
                .median_interval = median_interval(values, confidence)};
}

}  // namespace stillpoint::eval
