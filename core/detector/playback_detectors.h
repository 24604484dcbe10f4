// SPDX-License-Identifier: BSD-3-Clause
/// Detectors that need no network: playback of recorded detections, and of ground truth with simulated
/// errors.
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

/// Ground truth with missed detections in bursts, jitter of the box edges, latency, and false positives, to
/// measure the effect of each error.
///
/// The errors in a frame depend only on the seed and the frame id, so that runs that skip frames get the same
/// errors. Misses occur in bursts: the frames are divided into spans of `burst_frames`, and an object is
/// missed in all frames of a span or in none. Objects are identified by their class and their index among the
/// boxes of that class in a set.
class SimulatedDetector : public ObjectDetector {
 public:
  /// @param truth by ascending time; must outlive the detector
  /// @throws InputError if the sets are not in temporal order
  SimulatedDetector(std::span<const DetectionSet> truth, const DetectorConfig& config, int seed);

  [[nodiscard]] DetectionSet detect(const Frame& frame) override;
  [[nodiscard]] std::string description() const override;
  [[nodiscard]] const DetectorCounters& counters() const override { return counters_; }

 private:
  [[nodiscard]] const DetectionSet* newest_at(Timestamp t) const;
  [[nodiscard]] bool is_missed(std::int64_t frame_id, const std::string& object) const;

  std::span<const DetectionSet> truth_;
  SimulatedDetectorConfig config_;
  int seed_;
  DetectorCounters counters_;
};

}  // namespace stillpoint
