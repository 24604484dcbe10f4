// SPDX-License-Identifier: BSD-3-Clause
/// Adaptive pixel noise from the reprojection errors of the window.
#pragma once

#include <algorithm>
#include <vector>

#include "core/backend/window/window.h"
#include "core/config/backend_config.h"

namespace stillpoint {

/// Stateless except for its buffers.
class ReprojectionErrorMonitor {
 public:
  /// Median reprojection error of usable landmarks in frames after their host [px]; 0 with fewer than 20
  /// observations whose error is finite.
  [[nodiscard]] double median_px(const Window& window, double focal_px);

 private:
  std::vector<Pose> T_c_w_;      ///< of each frame
  std::vector<double> squared_;  ///< error of each observation [normalized image plane]
};

/// Low-pass filtered factor f on `pixel_sigma_px`: with e the median reprojection error and e0 its nominal
/// value `reprojection_error_px`,
///
///   f <- f + 0.1 (clamp((e / e0)^2, f_min, f_max) - f),   f_min, f_max = `min_`, `max_pixel_noise_factor`.
///
/// Most of a larger error is model error (distortion, blur, rolling shutter, compression, patches that change
/// with the view). It is correlated along a track, so the observations carry less information than their
/// variance suggests; hence the square of the ratio.
class PixelNoise {
 public:
  /// Updates the factor after a solve. @param error_px median reprojection error; 0 or not finite = unknown,
  /// ignored
  void observe(double error_px, const BackendConfig& config);

  /// The newest features are not where they were predicted: something is not as it was when their errors were
  /// small, so the factor is at least 1 again.
  void expect_errors() { factor_ = std::max(factor_, 1.0); }

  /// The configuration with `pixel_sigma_px` multiplied by the factor.
  [[nodiscard]] BackendConfig applied_to(BackendConfig config) const;

 private:
  double factor_ = 1.0;
};

}  // namespace stillpoint
