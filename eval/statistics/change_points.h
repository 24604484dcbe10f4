// SPDX-License-Identifier: BSD-3-Clause
/// Where the level of a series changes: E-divisive (Matteson and James, "A Nonparametric Approach for
/// Multiple Change Point Analysis of Multivariate Data", JASA 109, 2014), for numbers, with exponent 1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stillpoint {

struct ChangePointOptions {
  std::size_t min_segment = 3;  ///< values between two changes, >= 2; so many must follow a change to show it
  double significance = 0.005;  ///< a change whose p-value is larger is none
  std::size_t permutations = 999;
  std::uint64_t seed = 1;  ///< of the permutations: the same values give the same changes
};

struct ChangePoint {
  std::size_t index = 0;  ///< of the first value of the new level
  double p_value = 0.0;   ///< of the permutation test by which it was found
};

/// Changes in the order of the values. The test permutes values within the segments found so far, and ends as
/// soon as a change can no longer be significant (Besag and Clifford 1991). About 40 values are needed before
/// a change that has `min_segment` values behind it can be significant at all: fewer have too few
/// permutations.
///
/// Time grows with the square of the number of values, and with the permutations for each change that is
/// found.
/// @param values finite
[[nodiscard]] std::vector<ChangePoint> change_points(std::span<const double> values,
                                                     const ChangePointOptions& options = {});

}  // namespace stillpoint
