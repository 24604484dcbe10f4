// SPDX-License-Identifier: BSD-3-Clause
/// Tracking result of one frame, the message from the tracker to the estimator, and the labels of its
/// features.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
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

enum class LabelClass : std::uint8_t {
  kStable,
  kDynamicObject,  ///< on a detected object, now or in an earlier frame
  kDynamicMotion,  ///< moves relative to the background, on an object of any class
};

/// Why a feature has its current label.
enum class LabelReason : std::uint8_t {
  kNone,                ///< no test found it dynamic
  kInsideMask,          ///< nearer than the depth threshold of a bounding box that contains it
  kHistory,             ///< labeled dynamic in an earlier frame and not cleared since
  kResidual,            ///< residual of Eq. (6) above the threshold, with optimized poses
  kPredictionResidual,  ///< residual above the threshold with the predicted pose of the newest frame
  kRecycled,            ///< was dynamic; enough observations agree with a static point
  kStatic,              ///< was dynamic, static since; the older observations belong to another point
  kMinimumKept,         ///< failed a test, but is needed to keep the minimum number of stable features
};

/// Names used in output files, in snake_case.
[[nodiscard]] constexpr std::string_view label_name(LabelClass label) {
  constexpr std::string_view kNames[] = {"stable", "dynamic_object", "dynamic_motion"};
  return kNames[static_cast<std::size_t>(label)];
}
[[nodiscard]] constexpr std::string_view reason_name(LabelReason reason) {
  constexpr std::string_view kNames[] = {"none",     "inside_mask",         "history",
                                         "residual", "prediction_residual", "recycled",
                                         "static",   "minimum_kept"};
  return kNames[static_cast<std::size_t>(reason)];
}

/// Result of dynamic feature recognition for one feature of one frame. Paper Sec. III-C, III-E.
struct DynamicLabel {
  std::int64_t id = 0;
  LabelClass label = LabelClass::kStable;
  LabelReason reason = LabelReason::kNone;
  std::optional<double> residual_px = std::nullopt;  ///< r_k of Eq. (6), px at the camera's focal length;
                                                     ///< nullopt if it was not evaluated
};

}  // namespace stillpoint
