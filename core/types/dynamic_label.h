// SPDX-License-Identifier: BSD-3-Clause
/// Result of dynamic feature recognition for one feature of one frame. Paper Sec. III-C, III-E.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace stillpoint {

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

struct DynamicLabel {
  std::int64_t id = 0;
  LabelClass label = LabelClass::kStable;
  LabelReason reason = LabelReason::kNone;
  std::optional<double> residual_px = std::nullopt;  ///< r_k of Eq. (6), px at the camera's focal length;
                                                     ///< nullopt if it was not evaluated
};

}  // namespace stillpoint
