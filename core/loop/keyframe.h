// SPDX-License-Identifier: BSD-3-Clause
/// Keyframes of loop closure as the odometry hands them over, and the description of their features; see
/// core/types/loop_report.h for what is kept.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/base/timestamp.h"
#include "core/config/loop_config.h"
#include "core/geometry/camera.h"
#include "core/geometry/covariance.h"
#include "core/types/detection.h"
#include "core/types/loop_report.h"

namespace stillpoint {

/// Number of different bits, 0 to 256.
[[nodiscard]] inline int hamming_distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

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

/// Corners of a keyframe with metric depth and ORB descriptors (Rublee et al. 2011, Sec. 4).
///
/// With an IMU the patch is oriented by gravity instead of its intensity centroid: the pattern is rotated by
/// the image direction of gravity g_c at the bearing (x, y),
///
///   angle = atan2(g_y - y g_z, g_x - x g_z)
///
/// the derivative of the projection of a point that moves along g_c. Unlike the centroid, it has no noise.
///
/// Describes the static features of the odometry, and up to 500 FAST corners on three image
/// scales, spread over the image. With `loop.exclude_dynamic` none is in a dynamic region or near a dynamic
/// feature. All have a depth between 0.2 m and 8 m that is measured by consistent pixels.
/// @param keyframe gray and depth image of the size of the camera
[[nodiscard]] std::vector<KeyframeFeature> keyframe_features(const DepartedKeyframe& keyframe,
                                                             const Camera& camera, const LoopConfig& config);

/// Whether a point at this pixel and depth is not to be described, see `loop.exclude_dynamic`.
/// @param depth_m > 0
[[nodiscard]] bool is_dynamic(const DepartedKeyframe& keyframe, const Eigen::Vector2f& pixel, double depth_m,
                              double radius_px);

}  // namespace stillpoint
