// SPDX-License-Identifier: BSD-3-Clause
#include "eval/statistics/bootstrap.h"

#include <algorithm>
#include <random>
#include <vector>

#include "eval/metrics/statistics.h"
#include "eval/statistics/random_index.h"

namespace stillpoint::eval {

std::optional<Interval> median_interval(std::span<const double> values, const BootstrapOptions& options) {
  if (values.empty()) return std::nullopt;
  std::mt19937_64 random(options.seed);
  std::vector<double> medians;
  medians.reserve(options.resamples);
  std::vector<double> sample(values.size());
  for (std::size_t i = 0; i < options.resamples; ++i) {
    std::generate(sample.begin(), sample.end(), [&] { return values[random_index(random, values.size())]; });
    medians.push_back(*percentile(sample, 0.5));
  }
  const double tail = 0.5 * (1.0 - options.confidence);
  return Interval{.low = *percentile(medians, tail), .high = *percentile(medians, 1.0 - tail)};
}

std::optional<Spread> spread(std::span<const double> values, const BootstrapOptions& options) {
  if (values.empty()) return std::nullopt;
  return Spread{.count = values.size(),
                .median = *percentile(values, 0.5),
                .quartiles = {.low = *percentile(values, 0.25), .high = *percentile(values, 0.75)},
                .worst = *std::max_element(values.begin(), values.end()),
                .median_interval = *median_interval(values, options)};
}

}  // namespace stillpoint::eval
