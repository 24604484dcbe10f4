// SPDX-License-Identifier: BSD-3-Clause
/// The bearings of the landmarks of a window as functions of time.
#pragma once

#include <vector>

#include "core/backend/window/window.h"

namespace stillpoint {

/// A bearing, its velocity on the image plane and its time.
struct TimedBearing {
  Eigen::Vector2d bearing = Eigen::Vector2d::Zero();   ///< normalized image plane
  Eigen::Vector2d seen = Eigen::Vector2d::Zero();      ///< by the camera of the rig
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< [1/s]
  double exposure_s = 0.0;  ///< row readout offset minus the time offset at which the state is defined
};

/// With an IMU the bearing velocity follows from the state instead of from finite differences. For a static
/// point p in the camera frame, with v_c the velocity and w the angular rate of the camera, in the camera
/// frame,
///
///   dp/dt = -v_c - w x p,    du/dt = (dp/dt_xy - u dp/dt_z) / p_z,    u = p_xy / p_z.
///
/// With `TimeOffsetModel::kInertial` the states are defined at the exposures: bearings are shifted by the
/// readout of their rows only, and do not depend on the time offset.
class ObservationModel {
 public:
  /// Reads the current states of the window; allocates only if it has more frames than all windows before.
  void read(const Window& window);

  /// @param position_w of the landmark, as `Window::position` gives it
  [[nodiscard]] TimedBearing at(const Landmark& landmark, int frame, const Eigen::Vector3d& position_w) const;

  /// Same as `Window::position`.
  [[nodiscard]] Eigen::Vector3d position(const Landmark& landmark) const;

 private:
  struct Camera {
    Eigen::Matrix3d R_c_w;
    Eigen::Vector3d p_w;         ///< of the camera
    Eigen::Vector3d velocity_c;  ///< -v_c: of a static point at the camera center [m/s]
    Eigen::Vector3d rate_c;      ///< w [rad/s]
    double time_offset_s;
  };

  bool inertial_ = false;
  bool at_exposure_ = false;
  std::vector<Camera> cameras_;
};

}  // namespace stillpoint
