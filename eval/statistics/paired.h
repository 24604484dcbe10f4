// SPDX-License-Identifier: BSD-3-Clause
/// What changes between two variants that were run on the same things, pair by pair.
#pragma once

#include <optional>
#include <span>

#include "eval/statistics/bootstrap.h"

namespace stillpoint {

/// One thing under both variants.
struct Pair {
  double base = 0.0;
  double changed = 0.0;
};

struct PairedDifference {
  std::size_t count = 0;
  double median = 0.0;  ///< of changed - base, in the unit of the values
  Interval interval;    ///< of that median
  /// Matched-pairs rank-biserial correlation (Kerby 2014, from Wilcoxon 1945): 1 when every pair grew, -1
  /// when every pair shrank, 0 when growth and shrinkage weigh the same. Independent of the unit.
  double effect = 0.0;
};

/// @return nothing without pairs
[[nodiscard]] std::optional<PairedDifference> paired_difference(std::span<const Pair> pairs,
                                                                const BootstrapOptions& options = {});

/// Median of changed / base - 1, and its interval.
struct RelativeChange {
  std::size_t count = 0;
  double median = 0.0;
  Interval interval;
};

/// Pairs whose base is 0 are left out, except that 0 to 0 is no change.
/// @return nothing without pairs that can be used
[[nodiscard]] std::optional<RelativeChange> relative_change(std::span<const Pair> pairs,
                                                            const BootstrapOptions& options = {});

}  // namespace stillpoint
