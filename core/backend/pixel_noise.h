// SPDX-License-Identifier: BSD-3-Clause
/// How far from what the window says its landmarks were really seen, and what that makes of the pixel noise.
#pragma once

#include <vector>

#include "core/backend/backend_config.h"
#include "core/backend/window.h"

namespace stillpoint {

/// Kept between windows for its memory only.
class MisfitMeter {
 public:
  /// Median distance between where frames after the host saw usable landmarks and where the window puts them
  /// [px]; 0 with fewer than 20 sightings.
  [[nodiscard]] double median_px(const Window& window, double focal_px);

 private:
  std::vector<Pose> T_c_w_;      ///< of each frame
  std::vector<double> squared_;  ///< distance of each sighting [normalised plane]
};

/// Follows the factor by which a camera's pixels err more than `pixel_sigma_px` says.
///
/// What lies beyond the nominal misfit is not noise but model: distortion, blur, rows read one after another,
/// compression. All sightings of a track share it, so they are worth less than their spread tells, and the
/// factor goes with the square of the misfit.
class PixelNoise {
 public:
  /// Takes in the misfit of a solved window. @param misfit_px 0 = unknown, changes nothing
  void observe(double misfit_px, const BackendConfig& config);

  /// The settings with the pixel noise that has been found.
  [[nodiscard]] BackendConfig applied_to(BackendConfig config) const;

 private:
  double factor_ = 1.0;
};

}  // namespace stillpoint
