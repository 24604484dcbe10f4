// SPDX-License-Identifier: BSD-3-Clause
/// How sure a median is: percentile bootstrap (Efron 1979), with seeds, so that the same data give the same
/// interval.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace stillpoint {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

struct BootstrapOptions {
  std::size_t resamples = 2000;
  double confidence = 0.95;
  std::uint64_t seed = 1;
};

/// Interval of the median. One value is its own interval: what it says of others is for the caller to judge.
/// @return nothing for an empty list
[[nodiscard]] std::optional<Interval> median_interval(std::span<const double> values,
                                                      const BootstrapOptions& options = {});

/// Summary of repeated runs of one thing. Never a mean: a single lost run would own it.
struct Spread {
  std::size_t count = 0;
  double median = 0.0;
  Interval quartiles;
  double worst = 0.0;  ///< the largest
  Interval median_interval;
};

/// @return nothing for an empty list
[[nodiscard]] std::optional<Spread> spread(std::span<const double> values,
                                           const BootstrapOptions& options = {});

}  // namespace stillpoint
