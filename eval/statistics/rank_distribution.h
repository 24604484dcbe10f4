// SPDX-License-Identifier: BSD-3-Clause
/// Exact null distributions of rank statistics, and the confidence intervals that they give.
///
/// Sign statistics: with ranks r_1 .. r_n and independent signs of probability 1/2,
///
///   T = sum of r_i with a positive sign,  P_i(T = t) = 1/2 P_(i-1)(T = t) + 1/2 P_(i-1)(T = t - r_i)
///
/// r_i = 1: binomial distribution of the number of values above the median. r_i = i: Wilcoxon signed-rank
/// statistic without ties (Wilcoxon, Biometrics Bull. 1, 1945).
///
/// Two samples of m and n values (Mann and Whitney, Ann. Math. Statist. 18, 1947, Eq. (1)):
///
///   U = number of pairs in which the value of the second sample is larger
///   P_(m,n)(U = u) = m / (m + n) P_(m-1,n)(U = u) + n / (m + n) P_(m,n-1)(U = u - m)
///
/// All of them are symmetric: P(T = t) = P(T = N - t), N: largest value of T.
///
/// Interval by inversion of such a test (Hodges and Lehmann, Ann. Math. Statist. 34, 1963): if T is the
/// number of positive values among N candidates c_i - theta, then
///
///   interval of theta = [c_(k), c_(N+1-k)],  k = max{k: P(T <= k - 1) <= (1 - confidence) / 2}
///
/// c_(k): k-th smallest candidate. With ties the confidence is larger (Noether, JASA 62, 1967).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace stillpoint::eval {

/// Closed interval.
struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Element t: P(T = t) for random signs of `ranks`; O(n sum of ranks).
[[nodiscard]] std::vector<double> sign_distribution(std::span<const std::size_t> ranks);

/// Element u: P(U = u) for samples of `first` and `second` values without ties; O(first^2 second^2).
[[nodiscard]] std::vector<double> mann_whitney_distribution(std::size_t first, std::size_t second);

/// Two-sided p-value min(1, 2 P(T <= t)) of a symmetric distribution.
/// @param distribution as `sign_distribution` or `mann_whitney_distribution`
/// @param t the smaller one of the statistic and its reflection
[[nodiscard]] double two_sided_p(std::span<const double> distribution, std::size_t t);

/// Interval between two candidates.
/// @param sorted       N candidates in ascending order
/// @param distribution P(T = t), t = 0 .. N
/// @param confidence   in (0, 1)
/// @return nullopt if even [c_(1), c_(N)] has less than the confidence: too few data
[[nodiscard]] std::optional<Interval> interval_of_candidates(std::span<const double> sorted,
                                                             std::span<const double> distribution,
                                                             double confidence);

}  // namespace stillpoint::eval
