// SPDX-License-Identifier: BSD-3-Clause
/// How somebody gets along a route: at a pace of their own, with stops, and out of the camera's way.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "datasets/synthetic/closed_route.h"

namespace stillpoint {

struct WalkStyle {
  double speed = 1.0;             ///< [m/s]
  double stops_per_minute = 4.0;  ///< on average
  double stop_s = 2.0;            ///< mean length of a stop
  double start_m = 0.0;           ///< place on the route at the beginning
  double yield_m = 1.0;  ///< stops when the way ahead is nearer than this to the camera, and steps back
};

/// Settled before rendering, so that any moment can be asked for in any order.
class Walk {
 public:
  /// @param camera_at position of the camera on the floor at a time
  Walk(const ClosedRoute& route, const WalkStyle& style,
       const std::function<Eigen::Vector2d(double t_s)>& camera_at, std::uint64_t random_key, double from_s,
       double to_s);

  struct State {
    Eigen::Vector2d position;
    double heading;     ///< [rad]
    double distance_m;  ///< walked; steps follow it
    double pace;        ///< speed as a share of the style's, for the size of the steps
  };
  [[nodiscard]] State at(double t_s) const;

 private:
  struct Step {
    double distance_m, speed;
  };
  ClosedRoute route_;
  double full_speed_;
  double from_s_;
  std::vector<Step> steps_;
};

}  // namespace stillpoint
