// SPDX-License-Identifier: BSD-3-Clause
/// Executes the pairs of runs of two builds for a comparison.
#pragma once

#include <string>
#include <vector>

#include "bench/model/stored_run.h"
#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// Names of the builds of a pair in a store.
struct BuildPair {
  std::string base;
  std::string head;
};

/// The runs of both sides.
struct ExecutedPairs {
  std::vector<StoredRun> base;
  std::vector<StoredRun> head;
};

/// Executes the pairs that the store lacks, in the order of the matrix, and reads all of them.
/// @param matrix of `paired_plan` or `paired_systems`
/// @param store need not exist
/// @throws Interrupted, and as `run_plan`
[[nodiscard]] ExecutedPairs execute_pairs(const PlanMatrix& matrix, const std::string& store,
                                          const BuildPair& builds);

}  // namespace stillpoint::bench
