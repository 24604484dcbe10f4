// SPDX-License-Identifier: BSD-3-Clause
/// Change points of a series of scalars by E-divisive (Matteson and James, "A Nonparametric Approach for
/// Multiple Change Point Analysis of Multivariate Data", JASA 109, 2014) with exponent alpha = 1.
///
/// Divergence of two adjacent segments X = {x_1 .. x_n}, Y = {y_1 .. y_m} (their Sec. 2):
///
///   E(X, Y) = 2 / (n m) sum_(i,j) |x_i - y_j|
///             - C(n,2)^-1 sum_(i<k) |x_i - x_k| - C(m,2)^-1 sum_(j<k) |y_j - y_k|
///   Q(X, Y) = n m / (n + m) E(X, Y)
///
/// Each step bisects the current segment with the largest Q, at the index t = argmax over t and k of
/// Q({x_1 .. x_t}, {x_(t+1) .. x_k}). The change is significant if p = (1 + #{r: Q_r >= Q}) / (R + 1) does
/// not exceed the significance level; Q_r: maximum after permutation r of the values within all current
/// segments, R: number of permutations. The procedure ends with the first change that is not significant.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stillpoint::eval {

struct ChangePointOptions {
  std::size_t min_segment = 3;     ///< minimum number of values before, between and after changes; >= 2
  double significance = 0.005;     ///< largest p-value of a reported change
  std::size_t permutations = 999;  ///< R
  std::uint64_t seed = 1;          ///< of the permutations; fixed for reproducible results
};

struct ChangePoint {
  std::size_t index = 0;  ///< of the first value after the change
  double p_value = 0.0;   ///< of the permutation test
};

/// Significant change points in increasing order. A permutation test ends early once its change can no longer
/// be significant (sequential Monte Carlo test, Besag and Clifford 1991). With fewer than about 40 values a
/// change followed by only `min_segment` values cannot be significant.
///
/// O(R n^2) for each change point, n: number of values.
/// @param values finite
/// @param options the same seed gives the same result
[[nodiscard]] std::vector<ChangePoint> change_points(std::span<const double> values,
                                                     const ChangePointOptions& options = {});

}  // namespace stillpoint::eval
