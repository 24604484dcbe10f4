// SPDX-License-Identifier: BSD-3-Clause
/// Paths of a wheeled robot with a forward-looking camera: a closed route or a recorded track, with
/// vibration.
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

/// Pose of a robot's base on the floor.
struct PlanarPose {
  double t_s = 0.0;                                    ///< path time
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< [m]
  double heading = 0.0;                                ///< [rad], continuous along a track
};

/// Recorded motion of a robot's base, and its camera.
struct RobotTrack {
  std::vector<PlanarPose> poses;  ///< at least 2, ordered by time
  double smoothing_s = 0.25;      ///< standard deviation of the filter that removes the noise of the poses
  double camera_forward_m = 0.0;  ///< position of the camera in front of the center of the base
  double camera_height_m = 0.9;
};

/// Path of the body along a recorded track: poses at equal intervals by linear interpolation, filtered by a
/// Gaussian kernel over time; the track's ends are extended by standing still. The same vibration as above.
[[nodiscard]] PathSpline robot_path(const RobotTrack& track, const PathRequest& request);

}  // namespace stillpoint::synth
