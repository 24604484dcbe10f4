// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/paired_plan.h"

#include "core/base/content_hash.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

/// Identifies a program by its content, so that a new build invalidates the cached runs.
std::string program_hash(const std::filesystem::path& program) {
  return hash_text(content_hash(eval::read_text_file(program)));
}

}  // namespace

// The prefixes distinguish the two sides if both are the same program.
std::string ProgramPair::base_build() const { return "base-" + program_hash(base); }
std::string ProgramPair::head_build() const { return "head-" + program_hash(head); }

PlanMatrix paired_plan(BenchPlan plan, const ProgramPair& programs, int pairs) {
  if (plan.kind != RunKind::kInstructions) plan.kind = RunKind::kTiming;
  plan.repetitions = 2 * pairs;
  plan.systems.clear();
  PlanMatrix matrix = expand_plan(plan, "", {});
  const std::string base_build = programs.base_build();
  const std::string head_build = programs.head_build();
  std::vector<PlannedRun> alternating;
  for (const PlannedRun& run : matrix.runs) {
    PlannedRun base = run;
    base.program = programs.base;
    base.identity.build = base_build;
    PlannedRun head = run;
    head.program = programs.head;
    head.identity.build = head_build;
    const bool base_first = run.identity.repetition % 2 == 1;
    alternating.push_back(base_first ? base : head);
    alternating.push_back(base_first ? head : base);
  }
  matrix.runs = std::move(alternating);
  matrix.keys.clear();
  for (const PlannedRun& run : matrix.runs) matrix.keys.push_back(run_key(run.identity));
  return matrix;
}

}  // namespace stillpoint::bench
