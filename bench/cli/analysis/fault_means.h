// SPDX-License-Identifier: BSD-3-Clause
/// `stillpoint stats imperfections`: means over sequences of runs with injected faults.
#pragma once

#include <string>
#include <vector>

#include "bench/cli/analysis/stats_table.h"
#include "bench/plan/bench_plan.h"

namespace stillpoint::bench {

/// Prints one row for each fault and variant, and one over all faults. With the ATE e_i of the successful
/// runs i and u_i of the undisturbed run with the same sequence and seed:
///
///   ATE    exp(mean(log e_i))        ratio    exp(mean(log(e_i / u_i)))
///
/// and the largest e_i, the number of lost runs (no pose for half of the frames or more), and the mean of the
/// false confidence, which is scored with faults only.
/// @throws InputError if no run has a fault
int stats_imperfections(const StatsArguments& arguments);

/// The variants of a plan, and the names of its external systems.
/// @throws InputError if a description cannot be read
[[nodiscard]] std::vector<std::string> compared_names(const BenchPlan& plan);

}  // namespace stillpoint::bench
