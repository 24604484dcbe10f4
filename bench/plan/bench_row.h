// SPDX-License-Identifier: BSD-3-Clause
/// Aggregates the runs of one variant on one sequence into a table row.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bench/plan/plan_matrix.h"
#include "bench/store/store.h"
#include "core/base/module_timings.h"

namespace stillpoint::bench {

/// Metrics are medians over the succeeded runs; missing ones are shown as "n/a".
struct BenchRow {
  std::string sequence;
  std::string variant;
  std::string sweep;     ///< "key = value"; empty outside a sweep
  std::string status;    ///< "ok", the outcome of a run that did not succeed, "not run" or "skipped"
  std::string reason;    ///< reason of a status other than "ok", or a warning
  std::size_t runs = 0;  ///< executed
  std::size_t succeeded_runs = 0;  ///< executed with outcome "ok"
  std::optional<double> ate_rmse_m;
  std::optional<double> rpe_trans_rmse_m_per_s;
  std::optional<double> rpe_rot_rmse_deg_per_s;
  std::optional<double> correct_rate;
  std::optional<double> coverage;
  std::optional<double> first_pose_s;
  std::array<std::optional<double>, kModuleCount> mean_ms;
};

/// All rows of a plan in its order, including those without executed runs.
[[nodiscard]] std::vector<BenchRow> plan_rows(const PlanMatrix& matrix, const Store& store);

}  // namespace stillpoint::bench
