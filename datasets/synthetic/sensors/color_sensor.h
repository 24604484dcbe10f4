// SPDX-License-Identifier: BSD-3-Clause
/// Color camera model: vignetting, exposure, shot and read noise, response curve.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "core/geometry/camera.h"
#include "datasets/synthetic/render/frame_renderer.h"

namespace stillpoint::synth {

/// Photon-transfer model of a camera (EMVA Standard 1288, 2016). Per pixel and channel
///
///   s = min(gain * v(theta) * L, 1),   v(theta) = 1 - vignetting * (1 - cos^4 theta)
///   I = round(255 * sqrt(clamp(s + sigma * n, 0, 1))),   sigma^2 = read_noise^2 + shot_noise * s
///
/// L: radiance; s: signal relative to saturation; theta: angle to the optical axis; n ~ N(0, 1). The defaults
/// describe a 1/4-inch webcam sensor with a well depth of 6000 electrons.
struct ColorSensor {
  double exposure_s = 0.008;   ///< exposure time; determines motion blur
  double read_noise = 0.004;   ///< standard deviation relative to saturation
  double shot_noise = 1.7e-4;  ///< 1 / well depth
  double vignetting = 0.5;  ///< fraction of the natural cos^4 fall-off (Kingslake) not corrected by the lens
  double exposure_swing =
      0.0;  ///< amplitude of slow brightness changes not compensated by auto-exposure [stops]
  double exposure_period_s = 7.0;  ///< period of these changes
};

/// Gain of the frame taken `t_s` seconds after the start.
[[nodiscard]] double exposure_gain(const ColorSensor& sensor, double t_s);

/// What differs from frame to frame.
struct FrameExposure {
  double gain = 1.0;  ///< scene gain times `exposure_gain`
  std::uint64_t noise_key = 0;
};

/// Applies the sensor model.
/// @return CV_8UC3 (R, G, B); gamma 2
[[nodiscard]] cv::Mat simulate_color(const RenderedFrame& frame, const Camera& camera,
                                     const ColorSensor& sensor, const FrameExposure& exposure);

}  // namespace stillpoint::synth
