// SPDX-License-Identifier: BSD-3-Clause
/// A sequence as the runners see it.
#pragma once

#include <functional>
#include <span>

#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/imu_sample.h"
#include "core/types/rig.h"

namespace stillpoint {

/// The spans outlive the run.
struct SensorInput {
  Rig rig;
  std::span<const Timestamp> frame_times;    ///< rising
  std::span<const ImuSample> imu;            ///< rising; may be empty
  std::span<const DetectionSet> detections;  ///< recorded boxes; may be empty
  std::span<const DetectionSet> true_boxes;  ///< what a perfect detector sees; may be empty
  std::function<Frame(std::size_t index)>
      load_frame;  ///< throws InputError for a picture that cannot be had;
                   ///< called by one thread at a time, by rising index
};

}  // namespace stillpoint
