// SPDX-License-Identifier: BSD-3-Clause
/// Alternating runs of two builds, so that slow changes of the machine state affect both equally.
#pragma once

#include <filesystem>
#include <string>

#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// Two builds of the program, and the build names under which their runs are stored.
struct ProgramPair {
  std::filesystem::path base;
  std::filesystem::path head;
  bool perturbed = true;  ///< whether the pairs get different perturbations of the input
  [[nodiscard]] std::string base_build() const;
  [[nodiscard]] std::string head_build() const;
};

/// Whether both programs accept the config key of the perturbation (bench/model/replicates.h). Executes them.
[[nodiscard]] bool accept_perturbation(const ProgramPair& programs);

/// The runs of one program without repetitions. Their kind is `kTiming`, unless the plan counts instructions;
/// external systems are removed.
/// @throws InputError as `expand_plan`
[[nodiscard]] PlanMatrix single_runs(BenchPlan plan);

/// Repeats each run `pairs` times with both programs, in the order base, head, head, base (ABBA): base is
/// first in odd repetitions. Repetition i has the perturbation seed i - 1, equal for base and head: the pairs
/// of a deterministic program are replicates, and the first one is the unperturbed run. A plan that varies
/// the perturbation itself is not changed.
/// @param runs as from `single_runs`
/// @param pairs at least 1
[[nodiscard]] PlanMatrix paired_plan(PlanMatrix runs, const ProgramPair& programs, int pairs);

}  // namespace stillpoint::bench
