// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint stats repeat`.
#pragma once

#include "bench/cli/analysis/stats_table.h"

namespace stillpoint::bench {

/// Prints for each repeated run whether its repetitions are bit-equal, else the first frame and stage that
/// differ. With another store (`StatsArguments::other`): for each run that both contain, the first frame in
/// which each stage differs, the largest distance of the poses, and both ATE.
/// @return exit code: findings if a run differs
/// @throws InputError if there is nothing to compare
[[nodiscard]] int stats_repeat(const StatsArguments& arguments);

}  // namespace stillpoint::bench
