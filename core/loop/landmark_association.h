// SPDX-License-Identifier: BSD-3-Clause
/// Landmarks of the map: points that several keyframes see.
#pragma once

#include <span>
#include <vector>

#include "core/loop/keyframe.h"
#include "core/loop/loop_consistency.h"
#include "core/loop/relative_pose_estimation.h"

namespace stillpoint {

/// A landmark as a keyframe measured it.
struct LandmarkObservation {
  int keyframe = 0;
  Eigen::Vector3d p_c = Eigen::Vector3d::Zero();  ///< in the camera frame [m]
};

struct MapLandmark {
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();  ///< median of its measured positions [m]
  std::vector<LandmarkObservation> observations;  ///< three or more, by keyframe, one of each
};

/// Features of the same track of the odometry are the same point, and so are features of the two keyframes of
/// a loop that match and agree with one rigid motion (relative_pose_estimation.h) close to that of the graph.
/// Points with two features of one keyframe are left out. Of the others, those
/// that most keyframes see are preferred: a further one is added while one of its keyframes has fewer than
/// 150.
/// @param T_m_b poses of the keyframes
[[nodiscard]] std::vector<MapLandmark> associate_landmarks(std::span<const Keyframe> keyframes,
                                                           std::span<const Pose> T_m_b,
                                                           std::span<const GraphLoop> loops,
                                                           const RelativePoseOptions& options);

}  // namespace stillpoint
