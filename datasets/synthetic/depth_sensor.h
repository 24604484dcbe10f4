// SPDX-License-Identifier: BSD-3-Clause
/// From true depth to the numbers of an active-stereo depth picture, registered to the colour camera.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

/// A RealSense D435 (Keselman et al. 2017; Ahn et al. 2019): errors live in disparity, so depth noise grows
/// with the square of distance, sigma_z = noise_per_m * z^2; what only one imager sees is a hole.
struct DepthSensor {
  double noise_per_m = 0.0016;  ///< [1/m]; a sub-pixel error of 0.05 px at focal_baseline 30
  double correlated_share =
      0.8;                 ///< of the noise's standard deviation; the matching window makes neighbours alike
  int correlation_px = 6;  ///< size of that window
  double focal_baseline_px_m = 30.5;   ///< 610 px times 0.05 m
  double disparity_step_px = 0.03125;  ///< 1/32 px; 0 = not quantised
  double min_m = 0.3;                  ///< nearer is a hole
  double max_m = 8.0;                  ///< farther is a hole
  double edge_dropout = 0.5;  ///< chance of a hole beside a jump in depth; 0 also turns stereo shadows off
  double units_per_m = 1000.0;
};

/// @param depth_m row by row; 0 = nothing there
/// @return CV_16UC1 in units of the sensor; 0 = not measured
[[nodiscard]] cv::Mat measure_depth(const std::vector<float>& depth_m, int width, int height,
                                    const DepthSensor& sensor, std::uint64_t noise_key);

}  // namespace stillpoint
