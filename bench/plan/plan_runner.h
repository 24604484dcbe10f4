// SPDX-License-Identifier: BSD-3-Clause
/// Carries out a plan, one child process after the other.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "bench/plan/bench_plan.h"
#include "bench/plan/bench_row.h"

namespace stillpoint {

struct PlanHooks {
  std::function<void(const std::string& what)> on_step;       ///< before each rendering and each run
  std::function<void(int done, int total)> on_rendered = {};  ///< after each frame of a rendering
  std::function<bool()> stop_requested = {};
};

/// Runs every variant on every sequence of a plan; what a run writes lies in `out`/SEQUENCE/VARIANT. A run
/// that fails gives a row that says why. After a request to stop, the rows so far are returned.
[[nodiscard]] std::vector<BenchRow> run_plan(const BenchPlan& plan, const std::filesystem::path& out,
                                             const PlanHooks& hooks);

/// The folder of recorded sequences: STILLPOINT_DATA, else ../shared/data from where the program is called.
[[nodiscard]] std::filesystem::path data_folder();

/// A variant's name as the name of a folder.
[[nodiscard]] std::string folder_name(std::string variant);

}  // namespace stillpoint
