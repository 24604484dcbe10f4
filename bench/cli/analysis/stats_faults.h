// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint stats faults`.
#pragma once

#include "bench/cli/analysis/stats_table.h"

namespace stillpoint::bench {

/// Prints a matrix of the faults of a plan and the variants: whether each run did as the plan expects, its
/// error after recovery and its false confidence; below it one row of totals per variant: false confidence
/// and missed availability of all frames, runs in which a wrong pose was called located for more than 0.5 s,
/// and the claimed standard deviation of undisturbed runs.
///
/// A run survived if it recovered in the same world with an error of at most three times the ATE of the
/// undisturbed run, or 2 cm, and a false confidence of at most 0.5 %. Else it lost honestly if its false
/// confidence is that small, and is wrong if not.
/// @return exit code: findings if a run of the first variant did not do as expected
[[nodiscard]] int stats_faults(const StatsArguments& arguments);

}  // namespace stillpoint::bench
