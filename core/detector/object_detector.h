// SPDX-License-Identifier: BSD-3-Clause
/// Detectors of potentially dynamic objects: interface, factory, and validation of boxes. Paper Sec. II,
/// object detection thread.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "core/config/detector_config.h"
#include "core/types/detection.h"
#include "core/types/frame.h"

namespace stillpoint {

/// Statistics of a detector over a run.
struct DetectorCounters {
  std::int64_t processed = 0;              ///< frames with a result
  std::int64_t skipped = 0;                ///< frames without: not scheduled, late, or not in the recording
  std::int64_t boxes = 0;                  ///< returned boxes
  std::int64_t clipped = 0;                ///< returned boxes that were clipped to the image
  std::int64_t rejected = 0;               ///< boxes that were inverted, not finite, or outside the image
  std::optional<std::int64_t> unrecorded;  ///< skipped frames that are not in the recording, if there is one

  void add(const DetectorCounters& other) {
    processed += other.processed;
    skipped += other.skipped;
    boxes += other.boxes;
    clipped += other.clipped;
    rejected += other.rejected;
    if (other.unrecorded) unrecorded = unrecorded.value_or(0) + *other.unrecorded;
  }
};

/// Extension point for detectors. `detect` is called once per frame, in order.
class ObjectDetector {
 public:
  virtual ~ObjectDetector() = default;

  /// Detects objects; the boxes have positive area and lie inside the image.
  /// @return a set with the timestamp of the frame
  /// @throws InputError if the image does not fit the detector
  [[nodiscard]] virtual DetectionSet detect(const Frame& frame) = 0;

  /// Actual implementation, for the run manifest, e.g. "network yolo.weights, opencv 4.6.0 cpu".
  [[nodiscard]] virtual std::string description() const = 0;

  [[nodiscard]] virtual const DetectorCounters& counters() const = 0;
};

/// Inputs of a detector besides its settings.
struct DetectorInput {
  std::span<const DetectionSet> boxes;           ///< recorded, or ground truth for the simulated detector; by
                                                 ///< ascending time; must outlive the detector
  std::span<const std::string> dynamic_classes;  ///< of dynamic.classes
  int seed = 1;
  /// Injected faults: applied to each result of a network or a simulation; may be empty.
  std::function<DetectionSet(DetectionSet)> change{};
};

/// Creates the detector selected by the config.
/// @throws InputError if a network cannot be loaded or has none of the dynamic classes, or if the boxes are
/// not in temporal order
[[nodiscard]] std::unique_ptr<ObjectDetector> make_object_detector(const DetectorConfig& config,
                                                                   const DetectorInput& input);

struct UsableBoxes {
  std::vector<Detection> detections;
  DetectorCounters counters;  ///< boxes, clipped and rejected
};

/// Clips boxes to the image and removes those without area inside it.
[[nodiscard]] UsableBoxes usable_boxes(std::vector<Detection> detections, cv::Size image_size);

/// @param source name of the sets in error messages
/// @throws InputError if the timestamps are not strictly ascending
void require_increasing(std::span<const DetectionSet> sets, const std::string& source);

}  // namespace stillpoint
