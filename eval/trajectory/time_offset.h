// SPDX-License-Identifier: BSD-3-Clause
/// Search for a constant offset between the clocks of an estimate and its ground truth.
#pragma once

#include <optional>

#include "core/types/trajectory.h"

namespace stillpoint {

struct TimeOffsetOptions {
  double max_offset_s = 1.0;
  double coarse_step_s = 0.02;
  double precision_s = 1e-5;
};

struct TimeOffset {
  double offset_s = 0.0;    ///< to be added to the estimate's stamps
  double ate_rmse_m = 0.0;  ///< aligned rigidly, at that offset
  double ate_rmse_at_zero_m = 0.0;
};

/// The offset with the smallest rigidly aligned ATE: a grid, then golden sections around its best point. A
/// tool to be asked for, never applied silently: an estimator's latency is not its clock. Nothing when fewer
/// than ten poses match at offset 0.
[[nodiscard]] std::optional<TimeOffset> find_time_offset(const Trajectory& gt, const Trajectory& est,
                                                         const TimeOffsetOptions& options = {});

}  // namespace stillpoint
