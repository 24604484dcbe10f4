// SPDX-License-Identifier: BSD-3-Clause
/// Interface of what finds objects that may move. Paper Sec. II, object detection thread.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/detector/detector_config.h"
#include "core/types/detection.h"
#include "core/types/frame.h"

namespace stillpoint {

/// What a detector did in a run.
struct DetectorCounters {
  std::int64_t looked = 0;    ///< pictures with an answer
  std::int64_t unlooked = 0;  ///< pictures without: not due, late, or nothing was recorded
  std::int64_t boxes = 0;     ///< handed out
  std::int64_t clipped = 0;   ///< of those, cut at the edge of the picture
  std::int64_t unusable = 0;  ///< boxes that were inverted, no numbers, or outside the picture: left out
};

/// One of the plug-in points of the house. One picture at a time, in order.
class ObjectDetector {
 public:
  virtual ~ObjectDetector() = default;

  /// Boxes in the picture, each with area and inside it.
  /// @return a set with the stamp of the picture
  /// @throws InputError if the detector and the picture do not fit
  [[nodiscard]] virtual DetectionSet detect(const Frame& frame) = 0;

  /// What is really at work, for the record of a run, e.g. "network yolo.weights, opencv 4.6.0 cpu".
  [[nodiscard]] virtual std::string description() const = 0;

  [[nodiscard]] virtual const DetectorCounters& counters() const = 0;
};

/// What detectors need besides their settings.
struct DetectorInput {
  std::span<const DetectionSet> boxes;           ///< recorded ones, or true ones for the simulated detector;
                                                 ///< by rising time; they outlive the detector
  std::span<const std::string> dynamic_classes;  ///< those that matter
  int seed = 1;
};

/// The detector that the config names.
/// @throws InputError if a network cannot be loaded or knows none of the classes that matter, or boxes are
/// not in order of time
[[nodiscard]] std::unique_ptr<ObjectDetector> make_object_detector(const DetectorConfig& config,
                                                                   const DetectorInput& input);

}  // namespace stillpoint
