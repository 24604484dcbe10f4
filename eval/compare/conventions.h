// SPDX-License-Identifier: BSD-3-Clause
/// Detects violations of conventions (units, constant time offset, frames, quaternion order) that explain
/// implausible errors of an estimate.
#pragma once

#include <optional>
#include <string>
#include <vector>

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

enum class Convention {
  kStampUnit,         ///< milli-, micro- or nanoseconds read as seconds, or another epoch
  kTimeOffset,        ///< constant time offset
  kQuaternionOrder,   ///< qw qx qy qz instead of qx qy qz qw
  kInvertedPoses,     ///< T_f_w instead of T_w_f
  kBodyFrame,         ///< poses of another body frame
  kSwappedArguments,  ///< the ground truth looks like an estimate and vice versa
};

struct ConventionFinding {
  Convention convention = Convention::kStampUnit;
  std::string message;  ///< the suspected violation, the evidence, and a remedy
};

/// Suspected violations in the order of the enum. The data are not modified.
[[nodiscard]] std::vector<ConventionFinding> find_convention_violations(const Trajectory& gt,
                                                                        const Trajectory& est);

}  // namespace stillpoint::eval
