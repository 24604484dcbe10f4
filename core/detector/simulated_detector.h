// SPDX-License-Identifier: BSD-3-Clause
/// A detector made of true boxes and known faults, to learn what each fault costs.
#pragma once

#include "core/detector/object_detector.h"

namespace stillpoint {

/// Misses objects in bursts, shakes edges, comes late, and sees people who are not there.
///
/// The faults of a picture depend on the seed and on the picture's number alone, so runs that skip pictures
/// meet the same ones. A miss takes whole bursts: an object's pictures are cut into spans of
/// `burst_frames`, and in each span it is missed altogether or not at all. An object is its class and its
/// place among the boxes of that class in a set.
class SimulatedDetector : public ObjectDetector {
 public:
  /// @param truth by rising time; outlives the detector
  /// @throws InputError if the sets are not in order
  SimulatedDetector(std::span<const DetectionSet> truth, const DetectorConfig& config, int seed);

  [[nodiscard]] DetectionSet detect(const Frame& frame) override;
  [[nodiscard]] std::string description() const override;
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  [[nodiscard]] const DetectionSet* newest_at(Timestamp t) const;
  [[nodiscard]] bool is_missed(std::int64_t frame_id, const std::string& object) const;

  std::span<const DetectionSet> truth_;
  SimulatedDetectorConfig config_;
  double max_difference_s_;
  int seed_;
  DetectorCounters counters_;
};

}  // namespace stillpoint
