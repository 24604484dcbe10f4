// SPDX-License-Identifier: BSD-3-Clause
/// Number of modes of a positive metric over repeated runs: groups of runs whose values differ by a factor
/// that their scatter does not explain, e.g. because a decision early in the run comes out in two ways.
///
/// Gap test of the logarithms y_1 <= ... <= y_n: for each split k with at least two values on each side,
///
///   G_k = (y_(k+1) - y_k) / s_k,  s_k^2 = (SS(y_1 .. y_k) + SS(y_(k+1) .. y_n)) / (n - 2)
///
/// SS(.): sum of squared deviations from the mean. At the k with the largest G_k, the values are two groups
/// if G_k exceeds the 95 % quantile of max_k G_k of n normal values, and the gap is a factor of 1.1 or more.
/// Both groups are then split further in the same way. G_k does not depend on the unit and scatter of the
/// values, so that unimodal lognormal values are called multimodal with a probability of at most 5 % at each
/// n (found by simulation, `modes_test`).
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace stillpoint::eval {

/// Fewer values tell nothing about modes.
inline constexpr std::size_t kMinModeValues = 5;

/// @param values finite
/// @return >= 1; nullopt for fewer than `kMinModeValues` values, or one that is not positive
[[nodiscard]] std::optional<std::size_t> mode_count(std::span<const double> values);

}  // namespace stillpoint::eval
