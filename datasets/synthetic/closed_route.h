// SPDX-License-Identifier: BSD-3-Clause
/// A closed way on the floor: a polygon with rounded corners, measured by its length.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace stillpoint {

class ClosedRoute {
 public:
  /// Starts a little after the first corner.
  /// @param corners   at least 3, no two neighbours at one place [m]
  /// @param radius_m  of the turns; less where the polygon's sides are too short for it
  ClosedRoute(const std::vector<Eigen::Vector2d>& corners, double radius_m);

  struct Place {
    Eigen::Vector2d position;
    double heading;  ///< [rad], continuous along the route and from lap to lap
    double bend;     ///< absolute curvature [rad/m]
  };
  /// @param distance_m along the route, of any sign and any number of laps
  [[nodiscard]] Place at(double distance_m) const;
  [[nodiscard]] double length_m() const { return distances_.back(); }

 private:
  std::vector<Eigen::Vector2d> points_;  // the last equals the first
  std::vector<double> distances_;
  std::vector<double> headings_;  // of the steps
};

}  // namespace stillpoint
