// SPDX-License-Identifier: BSD-3-Clause
/// Faults of single frames: functions from a frame to a frame, and a person directly in front of the camera.
/// Images are copied before they are changed, because copies of a frame share their pixels.
#pragma once

#include <cstddef>
#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "core/types/frame.h"
#include "datasets/faults/sensor_fault.h"

namespace stillpoint::datasets {

/// The person of one fault, whose trunk fills a part of the image at its full height. The clothes are those
/// of rendered people.
class Occluder {
 public:
  /// @param image    size of the images
  /// @param fraction of the image that the trunk covers, in [0, 1]
  /// @param seed     of the clothes
  Occluder(cv::Size image, double fraction, std::uint64_t seed);

  /// The frame with a trunk at 0.45 m over gray, color and depth. Thread-safe.
  /// @param index position of the frame in the sequence; the trunk sways with it
  [[nodiscard]] Frame in_front_of(Frame frame, std::size_t index) const;

 private:
  cv::Size trunk_;
  cv::Mat clothes_;       ///< CV_8UC3 (R, G, B) of the size of the trunk
  cv::Mat gray_clothes_;  ///< CV_8UC1
};

/// Applies a fault of the targets `kImages` or `kDepth` that needs nothing but the frame: all but frozen,
/// dropped, depth_previous and occluder. The result depends on the fault and the index only.
/// @param frame gray, and color or depth if not empty
/// @param index position of the frame in the sequence
[[nodiscard]] Frame frame_with_fault(Frame frame, const SensorFault& fault, std::size_t index);

}  // namespace stillpoint::datasets
