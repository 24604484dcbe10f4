// SPDX-License-Identifier: BSD-3-Clause
/// Plays back recorded detections, so that a run needs no network.
#pragma once

#include "core/detector/object_detector.h"

namespace stillpoint {

/// Returns the set nearest in time to the frame, within a tolerance; else an empty set with state `kNone`.
class RecordedDetector : public ObjectDetector {
 public:
  /// @param sets by ascending time; must outlive the detector
  /// @param max_time_difference_s tolerance between the timestamps of a frame and its set [s]
  /// @throws InputError if the sets are not in temporal order
  RecordedDetector(std::span<const DetectionSet> sets, double max_time_difference_s);

  [[nodiscard]] DetectionSet detect(const Frame& frame) override;
  [[nodiscard]] std::string description() const override;
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  std::span<const DetectionSet> sets_;
  double max_difference_s_;
  DetectorCounters counters_;
};

}  // namespace stillpoint
