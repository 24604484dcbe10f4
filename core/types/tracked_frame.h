// SPDX-License-Identifier: BSD-3-Clause
/// What the tracker tells the estimator about one picture.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/base/module_timings.h"
#include "core/base/timestamp.h"

namespace stillpoint {

/// One point followed from picture to picture.
struct TrackedFeature {
  std::int64_t id = 0;                              ///< unique in a run, never used again
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< [px], as in the (distorted) picture
  Eigen::Vector2d bearing =
      Eigen::Vector2d::Zero();  ///< undistorted normalised plane (x, y), the ray is (x, y, 1)
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< of the bearing [1/s]; 0 when new
  double depth = 0.0;                                  ///< [m]; 0 = not measured
  int age = 1;                                         ///< pictures that have seen it, this one included
};

/// Features in order of their id.
struct TrackedFrame {
  std::int64_t id = 0;
  Timestamp t;
  std::vector<TrackedFeature> features;
  cv::Mat depth;  ///< registered raw depth, for the semantic mask; shares pixels with the Frame
  double depth_units_per_m = 1000.0;
  int lost = 0;      ///< features that KLT or RANSAC gave up in this picture
  int detected = 0;  ///< features born in this picture
  ModuleTimings timings;
};

}  // namespace stillpoint
