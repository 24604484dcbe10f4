// SPDX-License-Identifier: BSD-3-Clause
/// Detector that processes every n-th frame only.
#pragma once

#include "core/detector/object_detector.h"

namespace stillpoint {

/// Forwards frames whose id is a multiple of n to another detector, and skips the others.
class SparseDetector : public ObjectDetector {
 public:
  /// @param every_n at least 1
  SparseDetector(std::unique_ptr<ObjectDetector> detector, int every_n)
      : detector_(std::move(detector)), every_n_(every_n) {}

  [[nodiscard]] DetectionSet detect(const Frame& frame) override {
    if (frame.id % every_n_ == 0) {
      DetectionSet found = detector_->detect(frame);
      counters_ = detector_->counters();
      counters_.skipped += skipped_;
      return found;
    }
    ++skipped_;
    ++counters_.skipped;
    return {.t = frame.t, .state = DetectionState::kNone, .detections = {}};
  }
  [[nodiscard]] std::string description() const override {
    return detector_->description() + ", every " + std::to_string(every_n_) + " frames";
  }
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  std::unique_ptr<ObjectDetector> detector_;
  int every_n_;
  std::int64_t skipped_ = 0;
  DetectorCounters counters_;
};

}  // namespace stillpoint
