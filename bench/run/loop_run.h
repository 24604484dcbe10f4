// SPDX-License-Identifier: BSD-3-Clause
/// Trajectories and score of a run with loop closure.
#pragma once

#include <span>
#include <vector>

#include "bench/model/metrics.h"
#include "core/types/loop_report.h"
#include "core/types/trajectory.h"

namespace stillpoint::bench {

struct LoopRun {
  /// T_m_c with the correction known at each frame; the frames of the odometry's trajectory, with a loaded
  /// map from the relocalization on, and those of later segments that are located in the map.
  Trajectory causal;
  Trajectory optimized;  ///< T_m_c after the last frame; without segments that are not located
  LoopReport report;
  bool has_map = false;  ///< a map of an earlier run was loaded
};

/// The odometry's trajectory with the final corrections, interpolated over time between the two next
/// keyframes of its segment: from C_k T to C_k+1 T for a pose T. C_k moves the pose that was the output at
/// the time of the keyframe to the final one, T_m_b T_b_c. If the output lacks that time, C_k = T_m_b
/// T_w_b^-1. The poses of the first segment are those of the odometry if it has no keyframes; later segments
/// that are not located are left out.
/// @param odometry T_w_c of each segment, by their number
[[nodiscard]] Trajectory optimized_trajectory(std::span<const Trajectory> odometry, const LoopReport& report);

/// @param gt of the camera
/// @param odometry the first segment, without corrections
[[nodiscard]] LoopScore score_loops(const Trajectory& gt, const Trajectory& odometry, const LoopRun& run);

}  // namespace stillpoint::bench
