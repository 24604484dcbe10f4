// SPDX-License-Identifier: BSD-3-Clause
/// The places of the synthetic world.
#pragma once

#include <cstdint>
#include <span>

#include "datasets/synthetic/furniture.h"
#include "datasets/synthetic/hand_motion.h"
#include "datasets/synthetic/robot_motion.h"
#include "datasets/synthetic/world.h"

namespace stillpoint {

/// A place with its light baked, and where a camera or a robot goes in it.
struct Scene {
  World world;
  Room room;
  Viewpoint viewpoint;                                 ///< of a hand-held camera
  RobotRoute route;                                    ///< of a robot
  std::vector<std::vector<Eigen::Vector2d>> walkways;  ///< closed ways for people
  std::vector<std::vector<Eigen::Vector2d>> cartways;  ///< and for carts and chairs
  std::vector<Place> seats;                            ///< free chairs
  Palette palette;
  double gain = 1.0;  ///< from the scene's light to the sensor's range
};

/// Furnished office of 8 x 7 m with four desks, as in the TUM freiburg3 sequences.
[[nodiscard]] Scene build_office(std::uint64_t seed);

/// Market hall of 30 x 20 m with rows of shelves.
[[nodiscard]] Scene build_market(std::uint64_t seed);

/// Dim corridor of 14 and 19 m around one corner, 2.4 m wide: plain walls, a few doors, boards and posters.
[[nodiscard]] Scene build_corridor(std::uint64_t seed);

/// How far a path must be raised to fly at a sensible height above the floor of its hall.
[[nodiscard]] Eigen::Vector3d hall_shift(std::span<const Eigen::Vector3d> path);

/// Furnished hall around a given path, with nothing in its way: walls at 2 m from its extremes, floor at 0.9
/// m.
/// @param path not empty, already shifted
[[nodiscard]] Scene build_hall(std::uint64_t seed, std::span<const Eigen::Vector3d> path);

}  // namespace stillpoint
