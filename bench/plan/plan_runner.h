// SPDX-License-Identifier: BSD-3-Clause
/// Makes the runs of a plan that a store lacks, each in a child process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "bench/plan/plan_matrix.h"
#include "bench/store/journal.h"

namespace stillpoint {

struct PlanHooks {
  std::function<void(const std::string& what)> on_step = {};  ///< before each rendering and each run
  std::function<void(int done, int total)> on_rendered = {};  ///< after each frame of a rendering
  std::function<void(std::size_t done, std::size_t total)> on_progress = {};  ///< after each run
  std::function<bool()> stop_requested = {};
};

struct PlanOptions {
  int jobs = 1;        ///< accuracy runs at a time; timing runs always go one by one
  bool retry = false;  ///< make runs again that did not end well
};

/// What a call did.
struct PlanReport {
  std::size_t made = 0;
  std::size_t kept = 0;     ///< were there before, or were made by another driver meanwhile
  std::size_t missing = 0;  ///< of sequences that are not at hand
  bool interrupted = false;
};

/// Makes every run of the matrix that has not ended yet, and enters it into the store as soon as it ends.
/// Runs whose data were bad are made again. Another driver may work on the same plan: runs that it has begun
/// are waited for.
/// @throws InputError if the store cannot be written any more; what is stored is kept
[[nodiscard]] PlanReport run_plan(const PlanMatrix& matrix, Journal& journal, const PlanOptions& options,
                                  const PlanHooks& hooks);

}  // namespace stillpoint
