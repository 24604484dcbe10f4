// SPDX-License-Identifier: BSD-3-Clause
/// Wilcoxon signed-rank test of paired differences, exact for any number of pairs (Wilcoxon, Biometrics
/// Bull. 1, 1945):
///
///   T+ = sum of the ranks of d_i > 0,  T- = sum of the ranks of d_i < 0
///   p = min(1, 2 P(T <= min(T+, T-)))
///
/// d_i: difference of pair i, ranked by |d_i|; equal |d_i| share their mean rank, d_i = 0 is omitted. The
/// distribution of T is conditional on these ranks. If both programs are equal, exchanging the values of a
/// pair changes nothing, so d_i is symmetric about 0, which is all that the test assumes.
///
/// Estimate and interval (Hodges and Lehmann, Ann. Math. Statist. 34, 1963) from the N = n (n + 1) / 2 means
/// of two differences, w_ij = (d_i + d_j) / 2, i <= j:
///
///   estimate = median of w_ij (pseudomedian),  interval = [w_(k), w_(N+1-k)]
///
/// k: see eval/statistics/rank_distribution.h. Zeros are not omitted here, and ties make the interval wider,
/// so that it may contain 0 although p is small.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "eval/statistics/rank_distribution.h"

namespace stillpoint::eval {

/// Smallest two-sided p-value that n pairs can reach: 2^(1-n), at most 1. The same holds for the interval of
/// a median.
[[nodiscard]] double smallest_p(std::size_t n);

/// Smallest n with smallest_p(n) <= significance: 6 for 0.05.
/// @param significance in (0, 1]
[[nodiscard]] std::size_t smallest_count(double significance);

struct SignedRank {
  std::size_t count = 0;
  double estimate = 0.0;  ///< pseudomedian, in the unit of the differences
  double p_value = 1.0;
  std::optional<Interval> interval;  ///< of the pseudomedian; nullopt if there are too few differences
};

/// O(n^3) for n differences.
/// @param differences finite
/// @param confidence of the interval, in (0, 1)
/// @return nullopt for an empty list
[[nodiscard]] std::optional<SignedRank> signed_rank(std::span<const double> differences,
                                                    double confidence = 0.95);

/// Matched-pairs rank-biserial correlation (Kerby, Compr. Psychol. 3, 2014), (T+ - T-) / (T+ + T-): 1 if
/// every difference is positive, -1 if every difference is negative, 0 if all are 0.
[[nodiscard]] double rank_biserial(std::span<const double> differences);

}  // namespace stillpoint::eval
