// SPDX-License-Identifier: BSD-3-Clause
/// Global bundle adjustment of the keyframes after the last frame: with landmarks in place of the loops of
/// the pose graph, whose edges summarize the same matches by one relative pose.
///
/// The minimum over the poses T_m_b, the landmarks X and the direction of gravity g in the map of
///
///   sum_odometry |r|^2 + sum_gravity |r|^2 + sum_observations rho(|r|^2)
///
/// with the residuals of pose_graph_factors.h and point_factor.h, and rho by Tukey with 3: observations of
/// wrong matches and of slowly moving objects have no effect. The landmarks are eliminated first (Triggs et
/// al. 2000, Sec. 6.1).
#pragma once

#include <span>

#include "core/loop/landmark_association.h"
#include "core/loop/pose_graph.h"
#include "core/types/loop_report.h"

namespace stillpoint {

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
