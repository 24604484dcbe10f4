// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/sensors/color_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {
namespace {

/// Vignetting factor v(theta) at a pixel.
float lens_transmission(const Camera& camera, double vignetting, int row, int column) {
  const double x = (column - camera.cx) / camera.fx, y = (row - camera.cy) / camera.fy;
  const double cosine_squared = 1.0 / (1.0 + x * x + y * y);
  return static_cast<float>(1.0 - vignetting * (1.0 - cosine_squared * cosine_squared));
}

}  // namespace

double exposure_gain(const ColorSensor& sensor, double t_s) {
  return std::exp2(sensor.exposure_swing * std::sin(2.0 * std::numbers::pi * t_s / sensor.exposure_period_s));
}

cv::Mat simulate_color(const RenderedFrame& frame, const Camera& camera, const ColorSensor& sensor,
                       const FrameExposure& exposure) {
  const auto& [gain, noise_key] = exposure;
  cv::Mat image(frame.height, frame.width, CV_8UC3);
  const auto read_variance = static_cast<float>(sensor.read_noise * sensor.read_noise);
  const auto shot_variance = static_cast<float>(sensor.shot_noise);
  std::size_t pixel = 0;
  for (int row = 0; row < frame.height; ++row) {
    auto* out = image.ptr<cv::Vec3b>(row);
    for (int column = 0; column < frame.width; ++column, ++pixel) {
      const float scale =
          static_cast<float>(gain) * lens_transmission(camera, sensor.vignetting, row, column);
      const Float4 light = frame.radiance[pixel] * scale;
      std::uint64_t bits = mix_bits(noise_key + pixel);
      for (int channel = 0; channel < 3; ++channel, bits >>= 12) {
        const float signal = std::min(light[channel], 1.0F);  // the pixel saturates before read-out
        const float sigma = std::sqrt(read_variance + shot_variance * signal);
        const float value = std::clamp(signal + sigma * normal_from_bits(bits), 0.0F, 1.0F);
        out[column][channel] = static_cast<std::uint8_t>(std::lround(255.0F * std::sqrt(value)));
      }
    }
  }
  return image;
}

}  // namespace stillpoint::synth
