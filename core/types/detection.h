// SPDX-License-Identifier: BSD-3-Clause
/// Boxes around objects that may move.
#pragma once

#include <string>
#include <vector>

#include "core/base/timestamp.h"

namespace stillpoint {

/// Edges [px], max > min; may reach beyond the picture.
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

/// All boxes of one picture. `kNone`: nobody looked; `kPresent` with no boxes: looked and found nothing.
struct DetectionSet {
  Timestamp t;
  DetectionState state = DetectionState::kNone;
  std::vector<Detection> detections;
};

}  // namespace stillpoint
