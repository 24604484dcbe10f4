// SPDX-License-Identifier: BSD-3-Clause
/// Rotation of the camera between frames by its features alone.
#pragma once

#include <optional>

#include "core/backend/health/feature_views.h"
#include "core/backend/start/rotation_alignment.h"

namespace stillpoint {

/// Successive rotations of the camera over 0.2 s or more. States and calibration of the window are only their
/// initial guess.
class CameraRotations {
 public:
  /// @param focal_px of the camera
  explicit CameraRotations(double focal_px);

  /// Adds the newest frame of a window with an IMU.
  /// @param window with labels of the newest features
  /// @return the rotation since the last view, if the frame is late enough for another view and at least 20
  /// features determine it
  [[nodiscard]] std::optional<CameraRotation> add(const Window& window);

 private:
  FeatureViews views_;
  Timestamp last_;  ///< stamp of the frame of the newest view
};

}  // namespace stillpoint
