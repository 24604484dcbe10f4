// SPDX-License-Identifier: BSD-3-Clause
/// Distribution-free tests by ranks, exact for any number of values, and the estimates and confidence
/// intervals that belong to them: of a median, of the shift between two samples, of paired differences.
///
/// Null distribution of sign statistics: with ranks r_1 .. r_n and independent signs of probability 1/2,
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
/// c_(k): k-th smallest candidate. With ties the confidence is larger (Noether, JASA 62, 1967). The three
/// tests below are cases of it:
///
/// 1. Median by order statistics (Thompson, Ann. Math. Statist. 7, 1936):
///
///   P(x_(k) <= median <= x_(n+1-k)) >= 1 - 2 P(B <= k - 1),  B ~ binomial(n, 1/2)
///
/// x_(k): k-th smallest of n values. It holds for any distribution of the values. The widest interval, k = 1,
/// misses the median with probability 2^(1-n), so there is none at 95 % for n < 6.
///
/// 2. Two-sample rank test (Mann and Whitney, as above) of values x_1 .. x_m and y_1 .. y_n:
///
///   U+ = #{(i, j): y_j > x_i},  U- = #{(i, j): y_j < x_i},  p = min(1, 2 P(U <= m n - max(U+, U-)))
///
/// Pairs of equal values thus count against a difference, which keeps p valid with ties. Estimate and
/// interval of the shift from x to y from the N = m n differences d_ij = y_j - x_i:
///
///   estimate = median of d_ij,  interval = [d_(k), d_(N+1-k)]
///
/// The interval excludes 0 if and only if p <= 1 - confidence. The smallest p is 2 m! n! / (m + n)!, so 95 %
/// requires for instance 4 and 4, or 3 and 5 values.
///
/// 3. Signed-rank test of paired differences (Wilcoxon, as above):
///
///   T+ = sum of the ranks of d_i > 0,  T- = sum of the ranks of d_i < 0
///   p = min(1, 2 P(T <= min(T+, T-)))
///
/// d_i: difference of pair i, ranked by |d_i|; equal |d_i| share their mean rank, d_i = 0 is omitted. The
/// distribution of T is conditional on these ranks. If both programs are equal, exchanging the values of a
/// pair changes nothing, so d_i is symmetric about 0, which is all that the test assumes.
///
/// Estimate and interval from the N = n (n + 1) / 2 means of two differences, w_ij = (d_i + d_j) / 2, i <= j:
///
///   estimate = median of w_ij (pseudomedian),  interval = [w_(k), w_(N+1-k)]
///
/// Zeros are not omitted here, and ties make the interval wider, so that it may contain 0 although p is
/// small.
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
  std::optional<std::size_t> modes;         ///< see modes.h
};

/// @param values finite
/// @param confidence of the interval, in (0, 1)
/// @return nullopt for an empty list
[[nodiscard]] std::optional<Spread> spread(std::span<const double> values, double confidence = 0.95);

/// Result of the two-sample rank test.
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

/// Smallest two-sided p-value that n pairs can reach: 2^(1-n), at most 1. The same holds for the interval of
/// a median.
[[nodiscard]] double smallest_p(std::size_t n);

/// Smallest n with smallest_p(n) <= significance: 6 for 0.05.
/// @param significance in (0, 1]
[[nodiscard]] std::size_t smallest_count(double significance);

/// Result of the signed-rank test.
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

/// One measurement under both variants.
struct Pair {
  double base = 0.0;
  double changed = 0.0;
};

/// changed - base, in the unit of the values.
struct PairedDifference {
  std::size_t count = 0;
  double median = 0.0;  ///< pseudomedian, to which the interval belongs
  double p_value = 1.0;
  std::optional<Interval> interval;  ///< nullopt if there are too few pairs
  double effect = 0.0;  ///< `rank_biserial`: 1 if every pair increased, -1 if every pair decreased
};

/// Paired comparison of two variants that were measured under the same conditions, by the signed-rank test.
/// @param pairs finite values
/// @param confidence of the interval, in (0, 1)
/// @return nullopt without pairs
[[nodiscard]] std::optional<PairedDifference> paired_difference(std::span<const Pair> pairs,
                                                                double confidence = 0.95);

/// changed / base - 1.
struct RelativeChange {
  std::size_t count = 0;
  double median = 0.0;  ///< pseudomedian, to which the interval belongs
  double p_value = 1.0;
  std::optional<Interval> interval;  ///< nullopt if there are too few values
};

/// Relative change over pairs. If all values are positive, the test is made on x_i = ln(changed_i / base_i),
/// and its estimate and interval are mapped by e^x - 1; then a factor of 2 and a factor of 1/2 compensate
/// each other. Otherwise x_i = (changed_i - base_i) / |base_i|. Pairs with base 0 are excluded, unless both
/// values are 0, which counts as no change.
/// @param pairs finite values
/// @param confidence of the interval, in (0, 1)
/// @return nullopt without usable pairs
[[nodiscard]] std::optional<RelativeChange> relative_change(std::span<const Pair> pairs,
                                                            double confidence = 0.95);

/// Whether the data exclude "no change": there is an interval, and it lies on one side of 0.
[[nodiscard]] bool is_significant(const PairedDifference& difference);
[[nodiscard]] bool is_significant(const RelativeChange& change);

}  // namespace stillpoint::eval
