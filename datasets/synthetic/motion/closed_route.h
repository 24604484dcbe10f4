// SPDX-License-Identifier: BSD-3-Clause
/// Closed route on the floor: a polygon with rounded corners, parametrized by arc length.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace stillpoint::synth {

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

}  // namespace stillpoint::synth
