// SPDX-License-Identifier: BSD-3-Clause
/// Exact two-sample rank test (Mann and Whitney, Ann. Math. Statist. 18, 1947) of values x_1 .. x_m and
/// y_1 .. y_n:
///
///   U+ = #{(i, j): y_j > x_i},  U- = #{(i, j): y_j < x_i},  p = min(1, 2 P(U <= m n - max(U+, U-)))
///
/// Pairs of equal values thus count against a difference, which keeps p valid with ties. Estimate and
/// interval of the shift from x to y (Hodges and Lehmann, Ann. Math. Statist. 34, 1963) from the N = m n
/// differences d_ij = y_j - x_i:
///
///   estimate = median of d_ij,  interval = [d_(k), d_(N+1-k)]
///
/// k: see eval/statistics/rank_distribution.h. The interval excludes 0 if and only if p <= 1 - confidence.
/// The smallest p is 2 m! n! / (m + n)!, so 95 % requires for instance 4 and 4, or 3 and 5 values.
#pragma once

#include <optional>
#include <span>

#include "eval/statistics/rank_distribution.h"

namespace stillpoint::eval {

struct RankSum {
  double shift = 0.0;
  double p_value = 1.0;
  std::optional<Interval> interval;  ///< of the shift; nullopt if there are too few values
};

/// O(m^2 n^2).
/// @param before, after finite values
/// @param confidence of the interval, in (0, 1)
/// @return nullopt if a side is empty
[[nodiscard]] std::optional<RankSum> rank_sum(std::span<const double> before, std::span<const double> after,
                                              double confidence = 0.95);

}  // namespace stillpoint::eval
