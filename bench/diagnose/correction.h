// SPDX-License-Identifier: BSD-3-Clause
/// Changes of a recording, its calibration or the configuration that undo a fault, and the recording with
/// them.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "datasets/sensor_stream.h"

namespace stillpoint::bench {

/// What undoes one fault.
struct Correction {
  /// Changes calibration, inertial samples, stamps (not the number of frames) or ground truth; may be empty.
  std::function<void(datasets::SequenceInfo&)> change{};
  double depth_factor = 1.0;  ///< true depth = factor * recorded depth
  bool mirrored = false;      ///< images, depth and boxes are mirrored left to right
  int depth_delay = 0;        ///< the depth for frame i is that of frame i + delay
  /// The depth for pixel p is that of pixel p + shift.
  Eigen::Vector2i depth_shift_px = Eigen::Vector2i::Zero();
  std::vector<std::string> settings{};  ///< of the configuration: "key=value"
};

/// Frames of a recording.
struct RecordingPart {
  std::size_t first = 0;
  std::size_t count = 0;  ///< >= 1
};

/// The part of the recording as if it began there, with the corrections in their order. Frames are numbered
/// from 0. Thread-safe as `stream`.
/// @param stream must outlive the result
[[nodiscard]] std::unique_ptr<datasets::SensorStream> corrected_part(
    const datasets::SensorStream& stream, const RecordingPart& part,
    const std::vector<Correction>& corrections);

}  // namespace stillpoint::bench
