// SPDX-License-Identifier: BSD-3-Clause
/// Paths of a camera: held in a hand (sums of sinusoids, including hand tremor), or looking forward on a
/// wheeled robot with vibration that follows a closed route or a recorded track.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/pose.h"
#include "datasets/synthetic/motion/path_spline.h"

namespace stillpoint::synth {

/// Closed route on the floor: a polygon with rounded corners, parametrized by arc length.
class ClosedRoute {
 public:
  /// The route starts shortly after the first corner.
  /// @param corners   at least 3, adjacent ones distinct [m]
  /// @param radius_m  turn radius; reduced where the sides are too short
  ClosedRoute(const std::vector<Eigen::Vector2d>& corners, double radius_m);

  struct RoutePoint {
    Eigen::Vector2d position;
    double heading;    ///< [rad], continuous along the route and from lap to lap
    double curvature;  ///< absolute curvature [rad/m]
  };
  /// @param distance_m along the route; any sign and any number of laps
  [[nodiscard]] RoutePoint at(double distance_m) const;
  [[nodiscard]] double length_m() const { return distances_.back(); }

 private:
  std::vector<Eigen::Vector2d> points_;  // the last equals the first
  std::vector<double> distances_;
  std::vector<double> headings_;  // of the segments
};

/// The motions of the TUM RGB-D dynamic sequences (Sturm et al. 2012).
enum class HandMotion { kXyz, kStatic, kRpy, kHalfsphere };

/// Mean position of the camera, and the point it looks at.
struct Viewpoint {
  Eigen::Vector3d eye_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_w = Eigen::Vector3d::UnitX();
};

/// Attitude of a camera (z forward, y down) in a world with z up. Angles [rad]; yaw from the x axis towards
/// y, pitch positive downwards, roll positive clockwise as seen from behind the camera.
[[nodiscard]] Eigen::Quaterniond camera_attitude(double yaw, double pitch, double roll);

/// Path of the body that carries a hand-held camera. Mean speeds as listed for the TUM sequences: xyz 0.2-0.3
/// m/s, rpy 20 deg/s (peaks 40-50), halfsphere 0.2 m/s and 18 deg/s, static 0.01 m/s. Amplitudes ramp from 40
/// % to 100 % over the first two seconds, for a moving but gentle start.
[[nodiscard]] PathSpline hand_path(HandMotion motion, const Viewpoint& view, const PathRequest& request);

struct RobotRoute {
  std::vector<Eigen::Vector2d> corners;  ///< of a closed polygon, at least 3 [m]
  double turn_radius_m = 1.0;
  double speed = 0.7;      ///< on straight segments [m/s]
  double turn_rate = 0.6;  ///< maximum [rad/s]
  double camera_height_m = 1.1;
};

/// Path of the body along a route. The seed determines the start (within the first 2 m of the route) and the
/// vibration. Wheel vibration: 0.4 mm and 0.1 degree at 7-17 Hz.
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
