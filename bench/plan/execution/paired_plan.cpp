// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/paired_plan.h"

#include <fmt/format.h>

#include "bench/config/config_text.h"
#include "bench/model/replicates.h"
#include "bench/process/child_process.h"
#include "core/base/content_hash.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

constexpr double kProbeLimit_s = 30.0;

/// Identifies a program by its content, so that a new build invalidates the cached runs.
std::string program_hash(const std::filesystem::path& program) {
  return hash_text(content_hash(eval::read_text_file(program)));
}

bool accepts_perturbation(const std::filesystem::path& program) {
  const ProcessResult result = run_process(
      {.program = program,
       .arguments = {"config", "show", "--set", fmt::format("{}=1", kPerturbationKey), "--variant", "vo"},
       .time_limit_s = kProbeLimit_s});
  return result.exit_code == 0 && result.signal == 0 && !result.timed_out;
}

/// Run `repetition` of a program, perturbed except for the first.
PlannedRun repeated(PlannedRun run, int repetition, bool perturbed) {
  run.identity.repetition = repetition;
  if (!perturbed || repetition == 1 || run.identity.axis == kPerturbationKey) return run;
  run.config.settings.push_back(fmt::format("{}={}", kPerturbationKey, repetition - 1));
  run.identity.config_hash = config_hash(load_config(run.config));
  return run;
}

PlannedRun of_program(PlannedRun run, const std::filesystem::path& program, const std::string& build) {
  run.program = program;
  run.identity.build = build;
  return run;
}

}  // namespace

// The prefixes distinguish the two sides if both are the same program.
std::string ProgramPair::base_build() const { return "base-" + program_hash(base); }
std::string ProgramPair::head_build() const { return "head-" + program_hash(head); }

bool accept_perturbation(const ProgramPair& programs) {
  return accepts_perturbation(programs.base) && accepts_perturbation(programs.head);
}

PlanMatrix single_runs(BenchPlan plan) {
  if (plan.kind != RunKind::kInstructions) plan.kind = RunKind::kTiming;
  plan.repetitions = 1;
  plan.systems.clear();
  return expand_plan(plan, "", {});
}

PlanMatrix paired_plan(PlanMatrix runs, const ProgramPair& programs, int pairs) {
  PlanMatrix matrix = std::move(runs);
  matrix.plan.repetitions = pairs;
  const std::vector<PlannedRun> single = std::move(matrix.runs);
  const std::string base_build = programs.base_build();
  const std::string head_build = programs.head_build();
  matrix.runs.clear();
  for (auto first = single.begin(); first != single.end();) {
    auto last = first;  // one after the runs on the same sequence
    while (last != single.end() && last->sequence == first->sequence) ++last;
    for (int repetition = 1; repetition <= pairs; ++repetition) {
      for (auto run = first; run != last; ++run) {
        const PlannedRun planned = repeated(*run, repetition, programs.perturbed);
        const PlannedRun base = of_program(planned, programs.base, base_build);
        const PlannedRun head = of_program(planned, programs.head, head_build);
        const bool base_first = repetition % 2 == 1;
        matrix.runs.push_back(base_first ? base : head);
        matrix.runs.push_back(base_first ? head : base);
      }
    }
    first = last;
  }
  matrix.keys.clear();
  for (const PlannedRun& run : matrix.runs) matrix.keys.push_back(run_key(run.identity));
  return matrix;
}

}  // namespace stillpoint::bench
