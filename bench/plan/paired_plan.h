// SPDX-License-Identifier: BSD-3-Clause
/// Runs of two programs in alternation, so that what changes on the machine meanwhile touches both alike.
#pragma once

#include <filesystem>
#include <string>

#include "bench/plan/plan_matrix.h"

namespace stillpoint {

/// Two builds of the program, and the names under which their runs are stored.
struct ProgramPair {
  std::filesystem::path base;
  std::filesystem::path head;
  [[nodiscard]] std::string base_build() const;
  [[nodiscard]] std::string head_build() const;
};

/// Every run of a plan's variants as `pairs` times base, head, head, base (ABBA): repetition 2k - 1 has base
/// first, repetition 2k head. Runs are timed, one by one, unless the plan counts instructions; other systems
/// take no part.
[[nodiscard]] PlanMatrix paired_plan(BenchPlan plan, const ProgramPair& programs, int pairs);

}  // namespace stillpoint
