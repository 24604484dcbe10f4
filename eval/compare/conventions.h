// SPDX-License-Identifier: BSD-3-Clause
/// Finds the usual mistakes of convention behind numbers that are too bad, or too strange, to be true.
#pragma once

#include <string>
#include <vector>

#include "core/types/trajectory.h"

namespace stillpoint {

enum class Convention {
  kStampUnit,         ///< milli-, micro- or nanoseconds taken for seconds, or another epoch
  kTimeOffset,        ///< a constant offset of the clocks
  kQuaternionOrder,   ///< qw first where qw last was expected
  kInvertedPoses,     ///< T_f_w where T_w_f was expected
  kBodyFrame,         ///< the poses are of another frame of the robot
  kSwappedArguments,  ///< the first file looks like an estimate, the second like ground truth
};

struct ConventionFinding {
  Convention convention = Convention::kStampUnit;
  std::string sentence;  ///< what it looks like, the evidence, and what to do
};

/// Findings in the order of the enum; empty when the numbers look as they should. Nothing is applied.
[[nodiscard]] std::vector<ConventionFinding> find_convention_mistakes(const Trajectory& gt,
                                                                      const Trajectory& est);

}  // namespace stillpoint
