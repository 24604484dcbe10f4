// SPDX-License-Identifier: BSD-3-Clause
/// Sensor data of a sequence: the input of the runners.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/loop_report.h"
#include "core/types/rig.h"

namespace stillpoint {

/// The spans must outlive the run.
struct SensorInput {
  Rig rig;
  std::span<const Timestamp> frame_times;  ///< ascending
  /// In order of time; a frame may arrive twice, and those beyond `frame_times` are ignored. Empty: each
  /// frame arrives at its timestamp.
  std::span<const FrameArrival> arrivals{};
  std::span<const ImuSample> imu;            ///< ascending; may be empty
  std::span<const DetectionSet> detections;  ///< recorded boxes; may be empty
  std::span<const DetectionSet> true_boxes;  ///< ground truth boxes; may be empty
  /// Injected faults: applied to the results of a network or a simulation; may be empty.
  std::function<DetectionSet(DetectionSet)> change_detections{};
  /// Decodes a frame; called by one thread at a time, with ascending index.
  /// @throws InputError for a frame that cannot be read
  std::function<Frame(std::size_t index)> load_frame;
  std::shared_ptr<const KeyframeMap> map;  ///< of an earlier run, for relocalization; may be null
};

}  // namespace stillpoint
