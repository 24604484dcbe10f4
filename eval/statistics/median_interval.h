// SPDX-License-Identifier: BSD-3-Clause
/// Exact confidence interval of a median by order statistics (Thompson, Ann. Math. Statist. 7, 1936):
///
///   P(x_(k) <= median <= x_(n+1-k)) >= 1 - 2 P(B <= k - 1),  B ~ binomial(n, 1/2)
///
/// x_(k): k-th smallest of n values. It holds for any distribution of the values. The widest interval, k = 1,
/// misses the median with probability 2^(1-n), so there is none at 95 % for n < 6.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "eval/statistics/rank_distribution.h"

namespace stillpoint::eval {

/// Shortest symmetric interval with at least this confidence.
/// @param values finite
/// @param confidence of the interval, in (0, 1)
/// @return nullopt if there are too few values
[[nodiscard]] std::optional<Interval> median_interval(std::span<const double> values,
                                                      double confidence = 0.95);

/// Summary of repeated measurements by order statistics, which are robust to a single lost run.
struct Spread {
  std::size_t count = 0;
  double median = 0.0;
  Interval quartiles;
  double worst = 0.0;                       ///< the largest
  std::optional<Interval> median_interval;  ///< nullopt if there are too few values
};

/// @param values finite
/// @param confidence of the interval, in (0, 1)
/// @return nullopt for an empty list
[[nodiscard]] std::optional<Spread> spread(std::span<const double> values, double confidence = 0.95);

}  // namespace stillpoint::eval
