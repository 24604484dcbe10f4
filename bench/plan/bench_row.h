// SPDX-License-Identifier: BSD-3-Clause
/// One run as a row of a table.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "core/base/module_timings.h"

namespace stillpoint {

/// Numbers that are missing are "n/a".
struct BenchRow {
  std::string sequence;
  std::string variant;
  std::string status;  ///< "ok", "failed", "interrupted" or "skipped"
  std::string reason;  ///< why it is not ok
  std::optional<double> ate_rmse_m;
  std::optional<double> rpe_trans_rmse_m_per_s;
  std::optional<double> rpe_rot_rmse_deg_per_s;
  std::optional<double> correct_rate;
  std::optional<double> coverage;
  std::optional<double> first_pose_s;
  std::array<std::optional<double>, kModuleCount> mean_ms;
};

/// Reads what a run left behind; sequence and variant are taken from `row`.
/// @throws InputError if the file is missing or is no result file
[[nodiscard]] BenchRow read_result(const std::filesystem::path& result_file, BenchRow row);

}  // namespace stillpoint
