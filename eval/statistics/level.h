// SPDX-License-Identifier: BSD-3-Clause
/// How far two levels of a series lie apart, and whether a series creeps instead of stepping.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "eval/statistics/paired.h"

namespace stillpoint {

/// Median of `after` over that of `before`, less 1; its interval resamples both sides.
/// @return nothing if a side is empty, or the median of `before` is 0 and the other's is not; `count` is that
/// of the shorter side
[[nodiscard]] std::optional<RelativeChange> level_change(std::span<const double> before,
                                                         std::span<const double> after,
                                                         const BootstrapOptions& options = {});

/// A straight line through a series, whatever its outliers.
struct Trend {
  double slope = 0.0;    ///< of one value to the next: median over all pairs (Theil 1950, Sen 1968)
  double start = 0.0;    ///< of the line, at the first value
  double p_value = 1.0;  ///< two-sided, of no trend (Mann 1945, Kendall 1975), with ties
};

/// @return nothing for fewer than 4 values, which have no significant order
[[nodiscard]] std::optional<Trend> trend_of(std::span<const double> values);

/// Whether the line fits better than the levels between the changes, by the information criterion of Schwarz
/// (1978) for Laplace's errors: a level and its place are two numbers, as a line is.
/// @param changes indices at which new levels begin
[[nodiscard]] bool line_fits_better(std::span<const double> values, const Trend& trend,
                                    const std::vector<std::size_t>& changes);

}  // namespace stillpoint
