// SPDX-License-Identifier: BSD-3-Clause
/// Active-stereo depth camera model, registered to the color camera.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>

namespace stillpoint::synth {

/// RealSense D435 (Keselman et al. 2017; Ahn et al. 2019). Noise acts on the disparity, so that depth noise
/// grows quadratically, sigma_z = noise_per_m * z^2:
///
///   d = fb / z + n * noise_per_m * fb,   d' = step * round(d / step),   z' = fb / d'
///
/// z: true depth; fb = focal_baseline_px_m; step = disparity_step_px; n: unit-variance noise, partly
/// correlated between neighbors. Pixels visible to only one imager are holes.
struct DepthSensor {
  double noise_per_m = 0.0016;  ///< [1/m]; a disparity error of 0.05 px at focal_baseline 30
  double correlated_fraction =
      0.8;                 ///< of the noise's standard deviation; correlation comes from the matching window
  int correlation_px = 6;  ///< size of that window
  double focal_baseline_px_m = 30.5;   ///< 610 px times 0.05 m
  double disparity_step_px = 0.03125;  ///< 1/32 px; 0 = not quantized
  double min_m = 0.3;                  ///< holes below
  double max_m = 8.0;                  ///< holes above
  double edge_dropout =
      0.5;  ///< probability of a hole at a depth discontinuity; 0 also disables stereo shadows
  double units_per_m = 1000.0;
};

struct TrueDepth {
  std::span<const float> depth_m;  ///< row-major; 0 = no surface
  int width = 0;
  int height = 0;
};

/// Applies the sensor model.
/// @return CV_16UC1 in units of 1 / units_per_m; 0 = no measurement
[[nodiscard]] cv::Mat simulate_depth(const TrueDepth& depth, const DepthSensor& sensor,
                                     std::uint64_t noise_key);

}  // namespace stillpoint::synth
