// SPDX-License-Identifier: BSD-3-Clause
/// What the subcommands of `stillpoint stats` do: each prints one table. They return exit codes.
#pragma once

#include "bench/cli/stats/stats_table.h"

namespace stillpoint::bench {

/// Prints the spread of each variant on each sequence.
/// @throws InputError if no run has the metric
int stats_summary(const StatsArguments& arguments);

/// Prints the spread at each point of a sweep.
/// @throws InputError if no run has the metric, or there is no sweep
int stats_sweep(const StatsArguments& arguments);

/// Prints the paired differences of each variant from its base: `arguments.base`, or else the `ablation_base`
/// of each plan.
/// @throws InputError if neither is given; the message lists the variants
int stats_ablation(const StatsArguments& arguments);

/// Prints for each repeated run whether its repetitions are bit-equal, else the first frame and stage that
/// differ. With another store (`StatsArguments::other`): for each run that both contain, the first frame in
/// which each stage differs, the largest distance of the poses, and both ATE.
/// @return findings if a run differs
/// @throws InputError if there is nothing to compare
int stats_repeat(const StatsArguments& arguments);

/// Prints a matrix of the faults of a plan and the variants: whether each run did as the plan expects, its
/// error after recovery and its false confidence; below it one row of totals per variant: false confidence
/// and missed availability of all frames of the runs that ended, runs in which a wrong pose was called
/// located for more than 0.5 s, and the claimed standard deviation of undisturbed runs. For programs: one row
/// per run.
///
/// A run survived if it recovered in the same world with an error of at most three times the ATE of the
/// undisturbed run, or 2 cm, and a false confidence of at most 0.5 %. Else it lost honestly if its false
/// confidence is that small, and is wrong if not.
/// @return findings if a run of the first variant did not do as expected
int stats_faults(const StatsArguments& arguments);

/// Prints one row for each fault and variant, and one over all faults. With the ATE e_i of the successful
/// runs i and u_i of the undisturbed run with the same sequence and seed:
///
///   ATE    exp(mean(log e_i))        ratio    exp(mean(log(e_i / u_i)))
///
/// neither if one of the errors is 0, and the largest e_i, the number of lost runs (no pose for half of the
/// frames or more), and the mean of the false confidence, which is scored with faults only.
/// @throws InputError if no run has a fault
int stats_imperfections(const StatsArguments& arguments);

}  // namespace stillpoint::bench
