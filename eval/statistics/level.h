// SPDX-License-Identifier: BSD-3-Clause
/// Relative change between two levels of a series, and tests for a linear trend instead of steps.
///
/// Theil-Sen line (Theil 1950, Sen 1968) of values y_0 .. y_(n-1):
///
///   slope = median over i < k of (y_k - y_i) / (k - i),  intercept = median over i of (y_i - slope i)
///
/// Mann-Kendall test of no trend (Mann 1945, Kendall 1975), with ties and continuity correction:
///
///   S = sum over i < k of sign(y_k - y_i)
///   Var(S) = (n (n-1) (2n+5) - sum over ties of t (t-1) (2t+5)) / 18,  t: number of equal values
///   z = max(|S| - 1, 0) / sqrt(Var(S)),  p = erfc(z / sqrt(2))  (two-sided)
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "eval/statistics/paired.h"

namespace stillpoint::eval {

/// Relative shift between two levels by the exact two-sample rank test (eval/statistics/rank_sum.h). If all
/// values are positive, the test is made on their logarithms, and its estimate and interval are mapped by
/// e^x - 1; otherwise they are divided by |median(before)|.
/// @param before, after finite values
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

/// Step between two adjacent segments that may share a trend. Of three models of the values around the
/// boundary t, the one with the smallest criterion (BIC, as above) decides:
///
///   line           y_i = a + b i                   2 parameters: the step is 0
///   step           y_i = a + c [i >= t]            3 parameters: c = median(after) - median(before)
///   step and line  y_i = a + b i + c [i >= t]      4 parameters: b is the median slope within the segments,
///   a and c
///                                                  are medians of y_i - b i
///
/// Values far from t are excluded: of a longer segment, the models use as many values as the shorter one has,
/// but at least 10.
/// @param before, after not empty
/// @return c, in the unit of the values
[[nodiscard]] double step_beside_trend(std::span<const double> before, std::span<const double> after);

}  // namespace stillpoint::eval
