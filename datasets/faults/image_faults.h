// SPDX-License-Identifier: BSD-3-Clause
/// Faults of single frames: functions from a frame to a frame, and a person directly in front of the camera.
/// Images are copied before they are changed, because copies of a frame share their pixels.
#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>
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

/// The frame whose images are averages along a line; unchanged if it is shorter than a pixel.
/// @param line_px motion of the image during the exposure
[[nodiscard]] Frame blurred_along(Frame frame, const Eigen::Vector2d& line_px);

/// Applies a fault of the targets `kImages` or `kDepth` that needs nothing but the frame: all but frozen,
/// dropped, depth_previous, occluder and exposure_blur. The result depends on the fault and the index only.
/// With a: amount, I: gray value, z: depth, u: random unit vector of the seed:
///
///   exposure_steps   I <- sqrt(2^(a r)) I, r: uniform in [-1, 1], another one every 20 frames; clipped
///   vignetting       I <- sqrt(1 - a (r / r_corner)^2) I,  r: distance to the image center
///   jpeg             blocks of 8x8 pixels: DCT, quantization by ITU-T T.81 Table K.1 for quality a, inverse
///   depth_bias       z <- z + a z^2: what a disparity error of a f b [px] causes, f b: focal length times
///                    baseline
///   depth_shift      z(p) <- z(p - a u), at the nearest pixel
///   depth_noise      z <- z + a z^2 n,  n: noise of unit variance, correlated over 8 px, another in each
///   frame
///
/// Square roots: gamma 2, as the renderer has; light is proportional to the square of the gray value.
/// @param frame gray, and color or depth if not empty
/// @param index position of the frame in the sequence
[[nodiscard]] Frame frame_with_fault(Frame frame, const SensorFault& fault, std::size_t index);

}  // namespace stillpoint::datasets
