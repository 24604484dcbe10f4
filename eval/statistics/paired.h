// SPDX-License-Identifier: BSD-3-Clause
/// Paired comparison of two variants that were measured under the same conditions, by the exact signed-rank
/// test (eval/statistics/signed_rank.h).
#pragma once

#include <optional>
#include <span>

#include "eval/statistics/median_interval.h"
#include "eval/statistics/signed_rank.h"

namespace stillpoint::eval {

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
