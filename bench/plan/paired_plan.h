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
  [[nodiscard]] std::string base_build() const;
  [[nodiscard]] std::string head_build() const;
};

/// Expands each run of the plan to `pairs` groups of base, head, head, base (ABBA order): base is first in
/// repetition 2k - 1, head is first in repetition 2k. The kind of the runs is `kTiming`, unless the plan
/// counts instructions; external systems are removed.
[[nodiscard]] PlanMatrix paired_plan(BenchPlan plan, const ProgramPair& programs, int pairs);

}  // namespace stillpoint::bench
