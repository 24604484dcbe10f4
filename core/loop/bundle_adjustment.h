// SPDX-License-Identifier: BSD-3-Clause
/// Global bundle adjustment of the keyframes after the last frame: with landmarks in place of the loops of
/// the pose graph, whose edges summarize the same matches by one relative pose.
///
/// The minimum over the poses T_m_b, the landmarks X and the direction of gravity g in the map of
///
///   sum_odometry |r|^2 + sum_gravity |r|^2 + sum_observations rho(|r|^2)
///
/// with the residuals of pose_graph_factors.h, and rho by Tukey with 3: observations of
/// wrong matches and of slowly moving objects have no effect. The landmarks are eliminated first (Triggs et
/// al. 2000, Sec. 6.1).
#pragma once

#include <span>
#include <vector>

#include "core/loop/keyframe.h"
#include "core/loop/loop_consistency.h"
#include "core/loop/loop_verification.h"
#include "core/loop/pose_graph.h"
#include "core/types/loop_report.h"

namespace stillpoint {

/// A landmark as a keyframe measured it.
struct LandmarkObservation {
  int keyframe = 0;
  Eigen::Vector3d p_c = Eigen::Vector3d::Zero();  ///< in the camera frame [m]
};

/// A point that several keyframes see.
struct MapLandmark {
  Eigen::Vector3d p_m = Eigen::Vector3d::Zero();  ///< median of its measured positions [m]
  std::vector<LandmarkObservation> observations;  ///< three or more, by keyframe, one of each
};

/// Features of the same track of the odometry are the same point, and so are features of the two keyframes of
/// a loop that match and agree with one rigid motion (loop_verification.h) close to that of the graph.
/// Points with two features of one keyframe are left out. Of the others, those
/// that most keyframes see are preferred: a further one is added while one of its keyframes has fewer than
/// 150.
/// @param T_m_b poses of the keyframes
[[nodiscard]] std::vector<MapLandmark> associate_landmarks(std::span<const Keyframe> keyframes,
                                                           std::span<const Pose> T_m_b,
                                                           std::span<const GraphLoop> loops,
                                                           const RelativePoseOptions& options);

struct BundleAdjustmentOptions {
  double bearing_sigma = 0.003;        ///< of an observation, on the normalized image plane
  double inverse_depth_sigma = 0.004;  ///< [1/m]
  double gravity_sigma_rad = 0.005;
};

struct BundleAdjustmentResult {
  std::vector<Pose> T_m_b;
  BundleAdjustmentSummary summary;
};

/// @param graph its poses are the initial ones, the first is constant; its loops are not used
/// @return the initial poses if the solver fails, or without landmarks
[[nodiscard]] BundleAdjustmentResult adjust_bundle(const PoseGraph& graph,
                                                   std::span<const Keyframe> keyframes,
                                                   std::span<const MapLandmark> landmarks,
                                                   const BundleAdjustmentOptions& options);

}  // namespace stillpoint
