// SPDX-License-Identifier: BSD-3-Clause
/// The runs of one variant on one sequence as a row of a table.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bench/plan/plan_matrix.h"
#include "bench/store/store.h"
#include "core/base/module_timings.h"

namespace stillpoint {

/// Numbers are medians over the runs that ended well (for one run its own); those that are missing are "n/a".
struct BenchRow {
  std::string sequence;
  std::string variant;
  std::string sweep;          ///< "key = value"; empty outside a sweep
  std::string status;         ///< "ok", what went wrong, "not made" or "skipped"
  std::string reason;         ///< why it is not ok, or what else is to be known
  std::size_t runs = 0;       ///< that were made
  std::size_t good_runs = 0;  ///< of these, that ended well
  std::optional<double> ate_rmse_m;
  std::optional<double> rpe_trans_rmse_m_per_s;
  std::optional<double> rpe_rot_rmse_deg_per_s;
  std::optional<double> correct_rate;
  std::optional<double> coverage;
  std::optional<double> first_pose_s;
  std::array<std::optional<double>, kModuleCount> mean_ms;
};

/// Every row of a plan in its order, also of runs that were not made.
[[nodiscard]] std::vector<BenchRow> plan_rows(const PlanMatrix& matrix, const Store& store);

}  // namespace stillpoint
