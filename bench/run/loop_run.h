// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories and score of a run with loop closure.
#pragma once

#include <vector>

#include "bench/model/metrics.h"
#include "core/types/loop_report.h"
#include "core/types/trajectory.h"

namespace stillpoint::bench {

struct LoopRun {
  /// T_m_c with the correction known at each frame; the frames of the odometry's trajectory, with a loaded
  /// map from the relocalization on.
  Trajectory causal;
  Trajectory optimized;  ///< T_m_c after the last frame
  LoopReport report;
  bool has_map = false;  ///< a map of an earlier run was loaded
};

/// The odometry's trajectory with the final corrections, interpolated over time between the two next
/// keyframes: from C_k T to C_k+1 T for a pose T. C_k moves the pose that was the output at the time of the
/// keyframe to the final one, T_m_b T_b_c. If no map is reported or the output lacks that time, C_k = T_m_b
/// T_w_b^-1. Equal to the odometry without keyframes.
/// @param odometry T_w_c
[[nodiscard]] Trajectory optimized_trajectory(const Trajectory& odometry, const LoopReport& report);

/// @param gt of the camera
[[nodiscard]] LoopScore score_loops(const Trajectory& gt, const LoopRun& run);

}  // namespace stillpoint::bench
