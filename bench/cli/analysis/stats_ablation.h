// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint stats ablation`.
#pragma once

#include "bench/cli/analysis/stats_table.h"

namespace stillpoint::bench {

/// Prints the paired differences of each variant from its base: `arguments.base`, or else the `ablation_base`
/// of each plan.
/// @return exit code
/// @throws InputError if neither is given; the message lists the variants
[[nodiscard]] int stats_ablation(const StatsArguments& arguments);

}  // namespace stillpoint::bench
