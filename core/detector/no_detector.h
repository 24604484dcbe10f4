// SPDX-License-Identifier: BSD-3-Clause
/// Null detector: processes no frame.
#pragma once

#include "core/detector/object_detector.h"

namespace stillpoint {

class NoDetector : public ObjectDetector {
 public:
  [[nodiscard]] DetectionSet detect(const Frame& frame) override {
    ++counters_.skipped;
    return {.t = frame.t, .state = DetectionState::kNone, .detections = {}};
  }
  [[nodiscard]] std::string description() const override { return "none"; }
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  DetectorCounters counters_;
};

}  // namespace stillpoint
