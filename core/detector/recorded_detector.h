// SPDX-License-Identifier: BSD-3-Clause
/// Boxes that a detector found earlier, so that a run needs no network.
#pragma once

#include "core/detector/object_detector.h"

namespace stillpoint {

/// Looks up the set of a picture's stamp, else the nearest one in time. A picture that has none was not
/// looked at (`kNone`).
class RecordedDetector : public ObjectDetector {
 public:
  /// @param sets by rising time; outlive the detector
  /// @param max_time_difference_s how far another stamp may be and still mean the same picture [s]
  /// @throws InputError if the sets are not in order
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
