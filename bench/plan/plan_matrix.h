// SPDX-License-Identifier: BSD-3-Clause
/// A plan written out: every run that it asks for.
#pragma once

#include <string>
#include <vector>

#include "bench/config/config_file.h"
#include "bench/plan/bench_plan.h"
#include "bench/plan/plan_sequences.h"
#include "bench/store/stored_run.h"
#include "bench/systems/external_system.h"

namespace stillpoint {

struct PlannedRun {
  std::size_t sequence = 0;  ///< in `PlanMatrix::sequences`
  RunIdentity identity;
  ConfigRequest config;           ///< of a run of our odometry
  int max_frames = 0;             ///< likewise; 0 = all
  std::size_t system = 0;         ///< in `PlanMatrix::systems`, of a run of another one
  std::filesystem::path program;  ///< that runs our odometry; empty = this one
};

struct PlanMatrix {
  BenchPlan plan;
  std::vector<PlanSequence> sequences;
  std::vector<ExternalSystem> systems;
  std::vector<PlannedRun> runs;   ///< sequence by sequence; variants alternate within a repetition
  std::vector<std::string> keys;  ///< of all runs of the plan, also those that filters leave out
};

/// @param build what is recorded as the build of our odometry
/// @param filters globs; a run takes part if each matches its sequence, variant or system
/// @throws InputError as `matching_presets` and `recorded_sequences`, and for a system that cannot be read
[[nodiscard]] PlanMatrix expand_plan(const BenchPlan& plan, const std::string& build,
                                     const std::vector<std::string>& filters);

/// A run in a line: sequence, variant, and what of seed, repetition and sweep the plan varies.
[[nodiscard]] std::string run_label(const BenchPlan& plan, const RunIdentity& identity);

}  // namespace stillpoint
