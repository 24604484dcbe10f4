// SPDX-License-Identifier: BSD-3-Clause
/// Bounding boxes of potentially dynamic objects, detected and followed over several frames, and operations
/// on them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/timestamp.h"

namespace stillpoint {

/// Edges [px], max > min; may extend beyond the image.
struct Box {
  double x_min = 0.0;
  double y_min = 0.0;
  double x_max = 0.0;
  double y_max = 0.0;

  friend bool operator==(const Box&, const Box&) = default;
};

struct Detection {
  std::string class_name;
  double score = 1.0;  ///< in [0, 1]
  Box box;
};

enum class DetectionState { kPresent, kLate, kNone };

/// Largest difference between the time stamps of a frame and its boxes: half the frame interval at 30 Hz.
inline constexpr double kMaxDetectionOffset_s = 0.016;

/// All boxes of one image. `kNone`: the detector did not process it; `kPresent` with no boxes: processed,
/// and nothing found.
struct DetectionSet {
  Timestamp t;
  DetectionState state = DetectionState::kNone;
  std::vector<Detection> detections;
};

/// False for inverted and empty boxes, and if any edge is NaN.
[[nodiscard]] inline bool has_area(const Box& box) { return box.x_max > box.x_min && box.y_max > box.y_min; }

[[nodiscard]] inline Eigen::Vector2d center_of(const Box& box) {
  return {0.5 * (box.x_min + box.x_max), 0.5 * (box.y_min + box.y_max)};
}

/// The edges are part of the box.
[[nodiscard]] inline bool contains(const Box& box, const Eigen::Vector2d& pixel) {
  return pixel.x() >= box.x_min && pixel.x() <= box.x_max && pixel.y() >= box.y_min && pixel.y() <= box.y_max;
}

[[nodiscard]] inline Box translated(const Box& box, const Eigen::Vector2d& offset_px) {
  return {.x_min = box.x_min + offset_px.x(),
          .y_min = box.y_min + offset_px.y(),
          .x_max = box.x_max + offset_px.x(),
          .y_max = box.y_max + offset_px.y()};
}

/// The box with every side moved outward by `margin_px`.
[[nodiscard]] inline Box expanded(const Box& box, double margin_px) {
  return {.x_min = box.x_min - margin_px,
          .y_min = box.y_min - margin_px,
          .x_max = box.x_max + margin_px,
          .y_max = box.y_max + margin_px};
}

/// Intersection of two boxes; has no area (see `has_area`) if they are disjoint.
[[nodiscard]] inline Box intersection(const Box& a, const Box& b) {
  return {.x_min = std::max(a.x_min, b.x_min),
          .y_min = std::max(a.y_min, b.y_min),
          .x_max = std::min(a.x_max, b.x_max),
          .y_max = std::min(a.y_max, b.y_max)};
}

/// Intersection over union, in [0, 1]; both boxes have area.
[[nodiscard]] inline double intersection_over_union(const Box& a, const Box& b) {
  const auto area = [](const Box& box) { return (box.x_max - box.x_min) * (box.y_max - box.y_min); };
  const Box common = intersection(a, b);
  if (!has_area(common)) return 0.0;
  return area(common) / (area(a) + area(b) - area(common));
}

/// Box of an object in the current frame, which is followed over several. Paper Sec. III-D.
struct TrackedBox {
  std::int64_t id = 0;  ///< object id, unique within a run
  std::string class_name;
  Box box;                   ///< detected, or predicted and grown [px]; without the margin of the mask
  bool compensated = false;  ///< predicted: not detected in this frame
};

}  // namespace stillpoint
