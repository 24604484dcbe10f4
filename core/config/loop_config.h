// SPDX-License-Identifier: BSD-3-Clause
/// Settings of loop closure: keyframes, place recognition, verification and the pose graph. Not in the paper;
/// the default is off.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

struct LoopConfig {
  bool enabled = false;
  int dof = 6;  ///< of a keyframe in the pose graph: 6 (position and attitude), or 4 (position and heading)
  /// A correction is applied to the output this many frames after the keyframe was handed over, so that the
  /// result does not depend on the time that the loop closure takes.
  int lag_frames = 30;

  // Keyframes
  double min_translation_m = 0.15;  ///< a keyframe is handed over after this motion since the last one,
  double min_rotation_deg = 8.0;    ///< or after this rotation
  int max_corners = 500;            ///< corners besides the tracked features
  double max_depth_m = 8.0;         ///< largest measured depth of a corner
  bool exclude_dynamic = true;      ///< no corners in the semantic mask or at dynamic features
  double dynamic_radius_px = 20.0;  ///< around a dynamic feature

  // Place recognition
  double min_gap_s = 8.0;  ///< between the two visits of a place
  int min_votes = 12;      ///< features that agree with a place
  int max_candidates = 2;  ///< places that are verified per keyframe

  // Verification
  double inlier_px = 3.0;            ///< largest reprojection error of an inlier [px]
  double depth_noise_per_m = 0.004;  ///< standard deviation of an inverse depth [1/m]
  int min_inliers = 30;
  double min_inlier_ratio = 0.35;  ///< of the matches
  double min_spread = 0.08;  ///< standard deviation of the inliers along their shorter axis, of the focal
                             ///< length
  double gate_chi2 = 27.9;   ///< largest squared Mahalanobis distance from the odometry: 99.99 % quantile,
                             ///< 6 degrees of freedom

  // Drift of the odometry: standard deviations of a random walk
  double drift_m_per_sqrt_m = 0.01;
  double drift_deg_per_sqrt_m = 0.1;
  double drift_deg_per_sqrt_s = 0.02;

  double gravity_sigma_deg = 0.3;  ///< of the direction of gravity in a keyframe

  /// Adjusts all keyframes and their landmarks after the last frame. Affects the optimized trajectory and the
  /// saved map only.
  bool final_bundle_adjustment = false;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, LoopConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("enabled", config.enabled);
  field("dof", config.dof, 4, 6);
  field("lag_frames", config.lag_frames, 0, 1000);
  field("min_translation_m", config.min_translation_m, 0.0, 100.0);
  field("min_rotation_deg", config.min_rotation_deg, 0.0, 180.0);
  field("max_corners", config.max_corners, 0, 5000);
  field("max_depth_m", config.max_depth_m, 0.1, 1000.0);
  field("exclude_dynamic", config.exclude_dynamic);
  field("dynamic_radius_px", config.dynamic_radius_px, 0.0, 1000.0);
  field("min_gap_s", config.min_gap_s, 0.0, 100000.0);
  field("min_votes", config.min_votes, 1, 10000);
  field("max_candidates", config.max_candidates, 1, 100);
  field("inlier_px", config.inlier_px, 0.1, 100.0);
  field("depth_noise_per_m", config.depth_noise_per_m, 1e-5, 1.0);
  field("min_inliers", config.min_inliers, 4, 10000);
  field("min_inlier_ratio", config.min_inlier_ratio, 0.0, 1.0);
  field("min_spread", config.min_spread, 0.0, 10.0);
  field("gate_chi2", config.gate_chi2, 0.1, 1e6);
  field("drift_m_per_sqrt_m", config.drift_m_per_sqrt_m, 1e-5, 10.0);
  field("drift_deg_per_sqrt_m", config.drift_deg_per_sqrt_m, 1e-5, 90.0);
  field("drift_deg_per_sqrt_s", config.drift_deg_per_sqrt_s, 1e-5, 90.0);
  field("gravity_sigma_deg", config.gravity_sigma_deg, 1e-3, 90.0);
  field("final_bundle_adjustment", config.final_bundle_adjustment);
}

}  // namespace stillpoint
