// SPDX-License-Identifier: BSD-3-Clause
/// Tracking result of one frame: the message from the tracker to the estimator.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/base/module_timings.h"
#include "core/base/timestamp.h"

namespace stillpoint {

/// One feature tracked from frame to frame.
struct TrackedFeature {
  std::int64_t id = 0;                              ///< unique in a run, never reused
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< [px] in the (distorted) image
  Eigen::Vector2d bearing =
      Eigen::Vector2d::Zero();  ///< undistorted normalized coordinates (x, y); the ray is (x, y, 1)
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< of the bearing [1/s]; 0 when new
  double depth = 0.0;                                  ///< [m]; 0 = not measured
  int age = 1;                                         ///< frames that observed it, including this one
};

/// Features are sorted by id.
struct TrackedFrame {
  std::int64_t id = 0;
  Timestamp t;
  std::vector<TrackedFeature> features;
  cv::Mat gray;   ///< for loop closure, else empty; shares pixels with the Frame
  cv::Mat depth;  ///< registered raw depth image, for the semantic mask; shares pixels with the Frame
  double depth_units_per_m = 1000.0;
  int lost = 0;           ///< features lost in this frame, by KLT or RANSAC
  int detected = 0;       ///< features newly detected in this frame
  bool repeated = false;  ///< bit-equal to the image before: no observation, no features
  ModuleTimings timings;
};

}  // namespace stillpoint
