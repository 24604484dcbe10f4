// SPDX-License-Identifier: BSD-3-Clause
/// Estimation of a constant time offset between an estimate and its ground truth.
#pragma once

#include <optional>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

struct TimeOffsetOptions {
  double max_offset_s = 1.0;
  double coarse_step_s = 0.02;
  double precision_s = 1e-5;
};

struct TimeOffset {
  double offset_s = 0.0;            ///< to be added to the estimate's stamps
  double ate_rmse_m = 0.0;          ///< at this offset, after SE(3) alignment
  double ate_rmse_at_zero_m = 0.0;  ///< at offset 0
};

/// The offset with the smallest ATE after SE(3) alignment: grid search, then golden-section search around the
/// best grid point. No protocol applies it automatically, because it would also hide the estimator's latency.
/// @return nullopt if fewer than ten poses match at offset 0
[[nodiscard]] std::optional<TimeOffset> find_time_offset(const Trajectory& gt, const Trajectory& est,
                                                         const TimeOffsetOptions& options = {});

}  // namespace stillpoint::eval
