// SPDX-License-Identifier: BSD-3-Clause
/// Detects violations of conventions (units, frames, quaternion order) that explain implausible errors.
#pragma once

#include <string>
#include <vector>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

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
