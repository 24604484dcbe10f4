// SPDX-License-Identifier: BSD-3-Clause
/// Bounding boxes of potentially dynamic objects.
#pragma once

#include <string>
#include <vector>

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

/// All boxes of one image. `kNone`: the detector did not process it; `kPresent` with no boxes: processed,
/// and nothing found.
struct DetectionSet {
  Timestamp t;
  DetectionState state = DetectionState::kNone;
  std::vector<Detection> detections;
};

}  // namespace stillpoint
