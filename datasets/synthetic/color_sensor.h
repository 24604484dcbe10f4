// SPDX-License-Identifier: BSD-3-Clause
/// From light to the numbers of a colour picture: vignetting, exposure, shot and read noise, response curve.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "core/geometry/camera.h"
#include "datasets/synthetic/frame_renderer.h"

namespace stillpoint {

/// Photon-transfer model of a camera (EMVA Standard 1288, 2016): variance = read_noise^2 + shot_noise *
/// signal, with the signal as a share of saturation. The defaults are those of a 1/4-inch webcam sensor of
/// 6000 electrons well depth.
struct ColorSensor {
  double exposure_s = 0.008;   ///< time the shutter is open; blur follows from it
  double read_noise = 0.004;   ///< [share of saturation]
  double shot_noise = 1.7e-4;  ///< 1 / well depth
  double vignetting =
      0.5;  ///< share of the natural cos^4 fall-off (Kingslake) that the lens does not correct
  double exposure_swing =
      0.0;  ///< peak of the slow change of brightness that auto-exposure lets through [stops]
  double exposure_period_s = 7.0;  ///< of that change
};

/// Gain of the frame taken `t_s` seconds after the start.
[[nodiscard]] double exposure_gain(const ColorSensor& sensor, double t_s);

/// @param base_gain brings the scene's light to the sensor's range
/// @param noise_key of this frame
/// @return CV_8UC3 (R, G, B); gamma 2
[[nodiscard]] cv::Mat develop(const RenderedFrame& frame, const Camera& camera, const ColorSensor& sensor,
                              double gain, std::uint64_t noise_key);

}  // namespace stillpoint
