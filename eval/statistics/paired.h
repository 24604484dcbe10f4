// SPDX-License-Identifier: BSD-3-Clause
/// Paired comparison of two variants that were measured under the same conditions.
///
/// Effect size: matched-pairs rank-biserial correlation (Kerby, Compr. Psychol. 3, 2014; ranks of Wilcoxon,
/// Biometrics Bull. 1, 1945):
///
///   r = (sum of ranks of d_i > 0 - sum of ranks of d_i < 0) / (sum of all ranks)
///
/// d_i: difference of pair i, ranked by |d_i|; equal |d_i| share their mean rank, d_i = 0 has none.
#pragma once

#include <optional>
#include <span>

#include "eval/statistics/bootstrap.h"

namespace stillpoint::eval {

/// One measurement under both variants.
struct Pair {
  double base = 0.0;
  double changed = 0.0;
};

struct PairedDifference {
  std::size_t count = 0;
  double median = 0.0;  ///< of changed - base, in the unit of the values
  Interval interval;    ///< of the median
  double effect = 0.0;  ///< r: 1 if every pair increased, -1 if every pair decreased
};

/// @return nullopt without pairs
[[nodiscard]] std::optional<PairedDifference> paired_difference(std::span<const Pair> pairs,
                                                                const BootstrapOptions& options = {});

/// Median of changed / base - 1, and its interval.
struct RelativeChange {
  std::size_t count = 0;
  double median = 0.0;
  Interval interval;
};

/// Pairs with base 0 are excluded, unless both values are 0, which counts as no change.
/// @return nullopt without usable pairs
[[nodiscard]] std::optional<RelativeChange> relative_change(std::span<const Pair> pairs,
                                                            const BootstrapOptions& options = {});

}  // namespace stillpoint::eval
