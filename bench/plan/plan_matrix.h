// SPDX-License-Identifier: BSD-3-Clause
/// The runs of a plan, and those of a plan with two builds of the program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/config/config_file.h"
#include "bench/model/stored_run.h"
#include "bench/plan/bench_plan.h"
#include "bench/plan/plan_sequences.h"
#include "bench/systems/external_system.h"

namespace stillpoint::bench {

struct PlannedRun {
  std::size_t sequence = 0;  ///< index into `PlanMatrix::sequences`
  RunIdentity identity;
  ConfigRequest config;  ///< of a run of this odometry
  int max_frames = 0;    ///< 0 = all
  /// Frames by which the run begins later, and seed of the noise of its gray images (of this odometry). A
  /// recording does not depend on the seed; run k of n seeds begins k - 1 frames later with other noise, so
  /// that the seeds are replicates: decisions that depend on the start and on the pixels differ.
  int later_frames = 0;
  std::string fault;              ///< injected sensor fault, canonical; empty = none
  std::size_t system = 0;         ///< index into `PlanMatrix::systems`, of a run of an external system
  std::filesystem::path program;  ///< executable of this odometry; empty = the current executable
  std::string commit_time;        ///< UTC, of a program that was built from a commit; empty = unknown
};

/// Whether a run is one of another program. Its mode is "external", or "external, realtime".
[[nodiscard]] inline bool is_external(const RunIdentity& identity) {
  return identity.mode.starts_with("external");
}

struct PlanMatrix {
  BenchPlan plan;
  std::vector<PlanSequence> sequences;
  std::vector<ExternalSystem> systems;
  std::vector<PlannedRun> runs;   ///< grouped by sequence; variants alternate within a repetition
  std::vector<std::string> keys;  ///< of all runs of the plan, including those excluded by filters
};

/// @param build recorded as the build of this odometry
/// @param filters globs; a run is included if each of them matches its sequence, variant or system
/// @throws InputError as `matching_presets`, `recorded_sequences` and `require_runs`, and if a system file
/// cannot be read
[[nodiscard]] PlanMatrix expand_plan(const BenchPlan& plan, const std::string& build,
                                     const std::vector<std::string>& filters);

/// One-line description of a run: sequence, variant, and seed, repetition and sweep point if the plan varies
/// them.
[[nodiscard]] std::string run_label(const BenchPlan& plan, const RunIdentity& identity);

/// The plan without this odometry, and with one external system.
/// @param system name or file of its description
[[nodiscard]] BenchPlan plan_of_system(BenchPlan plan, const std::string& system);

/// The runs with the only external system replaced by one of its versions.
/// @param runs of `plan_of_system`
/// @param version with its build, see bench/systems/source_builds.h
/// @param commit_time UTC
[[nodiscard]] PlanMatrix with_version(PlanMatrix runs, const ExternalSystem& version,
                                      const std::string& commit_time);

/// A program of this odometry that was built from a commit.
struct BuiltProgram {
  std::filesystem::path program;
  std::string commit;
  std::string commit_time;  ///< UTC
};

/// The runs of this odometry by another program.
[[nodiscard]] PlanMatrix with_program(PlanMatrix runs, const BuiltProgram& built);

/// Two builds of the program, and the build names under which their runs are stored.
struct ProgramPair {
  std::filesystem::path base;
  std::filesystem::path head;
  bool perturbed = true;  ///< whether the pairs get different perturbations of the input
  [[nodiscard]] std::string base_build() const;
  [[nodiscard]] std::string head_build() const;
};

/// Whether both programs accept the config key of the perturbation (bench/model/stored_run.h). Executes them.
[[nodiscard]] bool accept_perturbation(const ProgramPair& programs);

/// The runs of one program without repetitions. Their kind is `kTiming`, unless the plan counts instructions;
/// external systems are removed.
/// @throws InputError as `expand_plan`
[[nodiscard]] PlanMatrix single_runs(BenchPlan plan);

/// Repeats each run `pairs` times with both programs, in the order base, head, head, base (ABBA): base is
/// first in odd repetitions, so that slow changes of the machine state affect both equally. Repetition i has
/// the perturbation seed i - 1, equal for base and head: the pairs of a deterministic program are replicates,
/// and the first one is the unperturbed run. A plan that varies the perturbation itself is not changed.
/// @param runs as from `single_runs`
/// @param pairs at least 1
[[nodiscard]] PlanMatrix paired_plan(PlanMatrix runs, const ProgramPair& programs, int pairs);

/// Two external systems, or two versions of one.
struct SystemPair {
  ExternalSystem base;
  ExternalSystem head;
};

/// The build under which the runs of one side are stored: its description and the files of its command.
[[nodiscard]] std::string system_build(const ExternalSystem& system, bool is_base);

/// The runs of an external system alone, without repetitions and without runs of this odometry.
/// @param plan its sequences, faults and limits
/// @param system name or file of its description
/// @throws InputError as `expand_plan`, and if the plan counts instructions
[[nodiscard]] PlanMatrix single_system_runs(BenchPlan plan, const std::string& system);

/// Repeats each run `pairs` times with both systems, in the order of `paired_plan`. Repetition i is
/// {repetition} in the command.
/// @param runs as from `single_system_runs`, of any of the two
/// @param pairs at least 1
[[nodiscard]] PlanMatrix paired_systems(PlanMatrix runs, const SystemPair& systems, int pairs);

}  // namespace stillpoint::bench
