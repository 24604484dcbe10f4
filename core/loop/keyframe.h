// SPDX-License-Identifier: BSD-3-Clause
/// Keyframes of loop closure, as the odometry hands them over; see core/types/keyframe_map.h for what is
/// kept.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/base/timestamp.h"
#include "core/geometry/uncertain_pose.h"
#include "core/loop/descriptor.h"
#include "core/types/detection.h"
#include "core/types/keyframe_map.h"

namespace stillpoint {

/// Static feature of the odometry.
struct StaticFeature {
  std::int64_t track = 0;                           ///< unique in a run
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  ///< [px]
  float depth_m = 0.0F;                             ///< 0 = not measured
};

/// Image region that belongs to a dynamic object.
struct DynamicRegion {
  Box box;  ///< [px]
  double near_m = 0.0;
  double far_m = 0.0;  ///< exclusive
};

/// A keyframe that leaves the window. Its vectors are reused.
struct DepartedKeyframe {
  std::int64_t frame = 0;
  Timestamp t;
  int segment = 0;  ///< of the odometry, see `OdometryUpdate`
  Pose T_w_b;
  Pose T_b_c;
  /// Of the motion from the keyframe before, T_bi_bj: (p + rho, q * Exp(theta)); absent if it is not known.
  std::optional<Matrix6> motion_covariance;
  std::optional<Eigen::Vector3d> gravity_b;  ///< unit vector; absent without an IMU
  cv::Mat gray;                              ///< CV_8UC1; shares pixels with the frame
  cv::Mat depth;                             ///< CV_16UC1, or empty; shares pixels with the frame
  double depth_units_per_m = 1000.0;
  std::vector<StaticFeature> features;
  std::vector<DynamicRegion> regions;
  std::vector<Eigen::Vector2f> dynamic_pixels;  ///< of dynamic features [px]
};

}  // namespace stillpoint
