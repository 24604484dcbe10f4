// SPDX-License-Identifier: BSD-3-Clause
/// Paths of a wheeled robot with a forward-looking camera: a closed route with vibration.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geometry/pose.h"
#include "datasets/synthetic/motion/path_spline.h"

namespace stillpoint::synth {

struct RobotRoute {
  std::vector<Eigen::Vector2d> corners;  ///< of a closed polygon, at least 3 [m]
  double turn_radius_m = 1.0;
  double speed = 0.7;      ///< on straight segments [m/s]
  double turn_rate = 0.6;  ///< maximum [rad/s]
  double camera_height_m = 1.1;
};

/// Path of the body that carries the camera. The seed determines the start (within the
/// first 2 m of the route) and the vibration. Wheel vibration: 0.4 mm and 0.1 degree at 7-17 Hz.
[[nodiscard]] PathSpline robot_path(const RobotRoute& route, const PathRequest& request);

}  // namespace stillpoint::synth
