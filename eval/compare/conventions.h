// SPDX-License-Identifier: BSD-3-Clause
/// Detects violations of conventions (units, scale, constant time offset, frames, quaternion order) that
/// explain implausible errors of an estimate.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/types/trajectory.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::eval {

/// Files whose quaternions are consistent with those of the other file if they are read in the other order.
struct OrderFinding {
  bool gt = false;
  bool est = false;
  double rpe_deg_per_s = 0.0;            ///< strict R.RPE as read
  double corrected_rpe_deg_per_s = 0.0;  ///< with the named files in the other order
};

/// Compares the R.RPE of the files as read with that of the estimate, the ground truth, or both in the other
/// order of quaternions. Two files with the same wrong order agree approximately, so both are tried, too.
/// @param gt ground truth
/// @param est estimate
/// @param offset_s added to the stamps of the estimate
/// @return nullopt if no other reading reduces the R.RPE to less than a third, or the R.RPE is less than
/// 0.5 deg/s, or fewer than ten poses match
[[nodiscard]] std::optional<OrderFinding> find_quaternion_order(const LoadedTrajectory& gt,
                                                                const LoadedTrajectory& est,
                                                                double offset_s = 0.0);

enum class Convention {
  kStampUnit,         ///< milli-, micro- or nanoseconds read as seconds, or another epoch
  kScale,             ///< another unit of length, scale of depth, or no scale
  kMirrored,          ///< a left-handed coordinate system
  kTimeOffset,        ///< constant time offset
  kQuaternionOrder,   ///< qw qx qy qz instead of qx qy qz qw
  kInvertedPoses,     ///< T_f_w instead of T_w_f, or only its rotation
  kBodyFrame,         ///< poses of another body frame
  kSwappedArguments,  ///< the ground truth looks like an estimate and vice versa
  kRepeatedPoses,     ///< the last pose again and again while the body moves
};

struct ConventionFinding {
  Convention convention = Convention::kStampUnit;
  std::string message;  ///< the suspected violation, the evidence, and a remedy
};

/// Stamps that are plausible as seconds only for a system that is far slower than a camera: one pose per 5 s,
/// or small whole numbers as those of frames.
[[nodiscard]] std::optional<ConventionFinding> find_implausible_stamps(const Trajectory& path);

/// A scale of the estimate that is off by 10 % or more and triples the ATE.
[[nodiscard]] std::optional<ConventionFinding> find_wrong_scale(const Trajectory& gt, const Trajectory& est);

/// Suspected violations in the order of the enum; those of frames and orders are tested on 20,000 poses of
/// the estimate. The data are not modified.
[[nodiscard]] std::vector<ConventionFinding> find_convention_violations(const Trajectory& gt,
                                                                        const Trajectory& est);

}  // namespace stillpoint::eval
