// SPDX-License-Identifier: BSD-3-Clause
/// Changes of a series of scalars: where it has steps, how large a step is, and whether a linear trend
/// explains the values better than steps.
///
/// Change points by E-divisive (Matteson and James, "A Nonparametric Approach for Multiple Change Point
/// Analysis of Multivariate Data", JASA 109, 2014) with exponent alpha = 1. Divergence of two adjacent
/// segments X = {x_1 .. x_n}, Y = {y_1 .. y_m} (their Sec. 2):
///
///   E(X, Y) = 2 / (n m) sum_(i,j) |x_i - y_j|
///             - C(n,2)^-1 sum_(i<k) |x_i - x_k| - C(m,2)^-1 sum_(j<k) |y_j - y_k|
///   Q(X, Y) = n m / (n + m) E(X, Y)
///
/// Each step bisects the current segment with the largest Q, at the index t = argmax over t and k of
/// Q({x_1 .. x_t}, {x_(t+1) .. x_k}). The change is significant if p = (1 + #{r: Q_r >= Q}) / (R + 1) does
/// not exceed the significance level; Q_r: maximum after permutation r of the values within all current
/// segments, R: number of permutations. The procedure ends with the first change that is not significant.
///
/// Trend by the Theil-Sen line (Theil 1950, Sen 1968) of values y_0 .. y_(n-1):
///
///   slope = median over i < k of (y_k - y_i) / (k - i),  intercept = median over i of (y_i - slope i)
///
/// and the Mann-Kendall test of no trend (Mann 1945, Kendall 1975), with ties and continuity correction:
///
///   S = sum over i < k of sign(y_k - y_i)
///   Var(S) = (n (n-1) (2n+5) - sum over ties of t (t-1) (2t+5)) / 18,  t: number of equal values
///   z = max(|S| - 1, 0) / sqrt(Var(S)),  p = erfc(z / sqrt(2))  (two-sided)
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "eval/statistics/rank_tests.h"

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

/// Relative shift between two levels by the exact two-sample rank test (eval/statistics/rank_tests.h). If all
/// values are positive, the test is made on their logarithms, and its estimate and interval are mapped by
/// e^x - 1; otherwise they are divided by |median(before)|.
/// @param before, after finite values
/// @param confidence of the interval, in (0, 1)
/// @return nullopt if a side is empty, or if only the median of `before` is 0; `count` is the size of the
/// smaller side
[[nodiscard]] std::optional<RelativeChange> level_change(std::span<const double> before,
                                                         std::span<const double> after,
                                                         double confidence = 0.95);

/// Robust linear fit of a series over its index.
struct Trend {
  double slope = 0.0;      ///< Theil-Sen, per index
  double intercept = 0.0;  ///< at index 0
  double p_value = 1.0;    ///< Mann-Kendall, two-sided
};

/// @return nullopt for fewer than 4 values, which cannot be significant
[[nodiscard]] std::optional<Trend> trend_of(std::span<const double> values);

/// Whether the line fits better than a piecewise constant function with steps at `changes`, by the Bayesian
/// information criterion (Schwarz 1978) with Laplace-distributed residuals r_i:
///
///   BIC = 2 n ln(1/n sum_i |r_i|) + q ln n
///
/// q: number of parameters, 2 for the line and 2 c + 1 for c steps (c + 1 levels and c positions). Constant
/// terms are omitted.
/// @param values the series
/// @param trend the line, as from `trend_of`
/// @param changes indices of the first value of each new level
[[nodiscard]] bool linear_trend_fits_better(std::span<const double> values, const Trend& trend,
                                            const std::vector<std::size_t>& changes);

/// Step between two adjacent segments that may have a trend. Three models of the nearest 20 values of each
/// segment are compared by the criterion above, with q parameters; t: boundary
///
///   line           y_i = a + b i                   q = 2
///   step           y_i = a + c [i >= t]            q = 6
///   step and line  y_i = a + b i + c [i >= t]      q = 8
///
/// A step counts as five parameters instead of one, because t was chosen by the data, so that the best of
/// many steps fits well by chance (Zhang and Siegmund, Biometrics 63, 2007). Simulated slow changes with a
/// noise of 0.3 to 2 % chose the number (tests/unit/analysis/drift_validation_test.cpp). The step is 0 if the
/// line is the best model; else the smallest of the differences of the levels after these trends are removed:
/// none, the median slope within the segments, the same of the nearest 20 values, and one slope for each
/// segment.
/// @param before, after not empty
/// @return in the unit of the values; 0 also if these differences have different signs
[[nodiscard]] double step_beside_trend(std::span<const double> before, std::span<const double> after);

}  // namespace stillpoint::eval
