// SPDX-License-Identifier: BSD-3-Clause
/// What the frames of a window saw of a landmark, as the reprojection residuals take it: in both solvers the
/// same.
#pragma once

#include <vector>

#include "core/backend/window.h"

namespace stillpoint {

/// A bearing, how it moves in the picture, and when it was exposed.
struct TimedBearing {
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();   ///< normalised plane
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< [1/s]
  double exposure_s = 0.0;  ///< exposure minus the time of the frame's state, less the time offset
};

/// Reads the states of a window once and then answers for its landmarks.
class ObservationModel {
 public:
  /// Takes over the window's present states; no allocation once as many frames have been read.
  void read(const Window& window);

  /// @param position_w of the landmark, as `Window::position` gives it
  [[nodiscard]] TimedBearing at(const Landmark& landmark, int frame, const Eigen::Vector3d& position_w) const;

  /// Same as `Window::position`.
  [[nodiscard]] Eigen::Vector3d position(const Landmark& landmark) const;

 private:
  struct Camera {
    Eigen::Matrix3d R_c_w;
    Eigen::Vector3d p_w;         ///< of the camera
    Eigen::Vector3d velocity_c;  ///< of a static point where the camera's centre is, as the camera sees it
    Eigen::Vector3d rate_c;      ///< [rad/s]
    double time_offset_s;
  };

  bool inertial_ = false;
  std::vector<Camera> cameras_;
};

}  // namespace stillpoint
