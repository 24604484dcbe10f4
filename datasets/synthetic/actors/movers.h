// SPDX-License-Identifier: BSD-3-Clause
/// What moves in a scene: people, articulated bodies that walk, or sit and make small movements; and a loaded
/// cart and an office chair, of classes that a person detector does not report. All but the seated follow a
/// closed route with random stops and keep clear of the camera.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "datasets/synthetic/actors/actor.h"
#include "datasets/synthetic/motion/camera_motion.h"
#include "datasets/synthetic/scenes/furniture.h"

namespace stillpoint::synth {

struct WalkStyle {
  double speed = 1.0;             ///< [m/s]
  double stops_per_minute = 4.0;  ///< on average
  double stop_s = 2.0;            ///< mean length of a stop
  double start_m = 0.0;           ///< initial position along the route
  double camera_clearance_m =
      1.0;  ///< stops if the route ahead comes closer to the camera than this, retreats if closer still
};

/// Camera to keep clear of, and the time interval to simulate.
struct CameraMotion {
  std::function<Eigen::Vector2d(double t_s)> camera_at;  ///< camera position on the floor
  double from_s = 0.0;
  double to_s = 0.0;
};

/// Motion along a closed route with random stops and camera avoidance. Simulated once on construction, so
/// that `at` is a pure function of time.
class Walk {
 public:
  Walk(const ClosedRoute& route, const WalkStyle& style, const CameraMotion& camera,
       std::uint64_t random_key);

  struct State {
    Eigen::Vector2d position;
    double heading;     ///< [rad]
    double distance_m;  ///< distance walked; drives the gait phase
    double pace;        ///< current speed / nominal speed, in [0, 1]; scales the step length
  };
  [[nodiscard]] State at(double t_s) const;

 private:
  struct Step {
    double distance_m, speed;
  };
  ClosedRoute route_;
  double nominal_speed_;
  double from_s_;
  std::vector<Step> steps_;
};

/// A walking person. @param object instance number
[[nodiscard]] Actor make_walking_person(Builder& builder, int object, const Walk& walk,
                                        std::uint64_t random_key);

/// A person sitting on the chair at `seat`, facing its front, who moves arms, trunk and head slightly.
[[nodiscard]] Actor make_seated_person(Builder& builder, int object, const Placement& seat,
                                       std::uint64_t random_key);

/// A platform trolley with cartons and packages that follows `walk`.
[[nodiscard]] Actor make_cart(const Palette& palette, int object, const Walk& walk, std::uint64_t random_key);

/// An office chair that follows `walk` and oscillates about its vertical axis.
[[nodiscard]] Actor make_rolling_chair(const Palette& palette, int object, const Walk& walk,
                                       std::uint64_t random_key);

}  // namespace stillpoint::synth
