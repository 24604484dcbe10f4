// SPDX-License-Identifier: BSD-3-Clause
/// Confidence interval of a median by the percentile bootstrap (Efron, Ann. Statist. 7, 1979):
///
///   m*_b = median of n values drawn from x_1 .. x_n with replacement,  b = 1 .. B
///   interval = [q_(a/2)(m*), q_(1-a/2)(m*)],  a = 1 - confidence
///
/// q_p: p-quantile over the B resamples. The generator has a fixed seed, so equal data give equal intervals.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace stillpoint::eval {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

struct BootstrapOptions {
  std::size_t resamples = 2000;  ///< B
  double confidence = 0.95;
  std::uint64_t seed = 1;
};

/// Confidence interval of the median. For a single value it has zero width.
/// @return nullopt for an empty list
[[nodiscard]] std::optional<Interval> median_interval(std::span<const double> values,
                                                      const BootstrapOptions& options = {});

/// Summary of repeated measurements by order statistics, which are robust to a single lost run.
struct Spread {
  std::size_t count = 0;
  double median = 0.0;
  Interval quartiles;
  double worst = 0.0;  ///< the largest
  Interval median_interval;
};

/// @return nullopt for an empty list
[[nodiscard]] std::optional<Spread> spread(std::span<const double> values,
                                           const BootstrapOptions& options = {});

}  // namespace stillpoint::eval
