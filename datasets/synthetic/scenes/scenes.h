// SPDX-License-Identifier: BSD-3-Clause
/// The synthetic scenes.
#pragma once

#include <cstdint>
#include <span>

#include "datasets/synthetic/motion/hand_motion.h"
#include "datasets/synthetic/motion/robot_motion.h"
#include "datasets/synthetic/render/world.h"
#include "datasets/synthetic/scenes/furniture.h"

namespace stillpoint::synth {

/// A static world with its baked lightmap, and the routes of camera, people and other moving objects.
struct Scene {
  World world;
  Room room;
  Viewpoint viewpoint;                                       ///< mean pose of a hand-held camera
  RobotRoute route;                                          ///< route of a robot-mounted camera
  std::vector<std::vector<Eigen::Vector2d>> walking_routes;  ///< closed polygons for people
  std::vector<std::vector<Eigen::Vector2d>> cart_routes;     ///< closed polygons for carts and chairs
  std::vector<Placement> seats;                              ///< free chairs
  Palette palette;
  double gain = 1.0;  ///< from scene radiance to sensor signal (1 = saturation)
};

/// Furnished office of 8 x 7 m with four desks, as in the TUM freiburg3 sequences.
[[nodiscard]] Scene build_office(std::uint64_t seed);

/// Market hall of 30 x 20 m with rows of shelves.
[[nodiscard]] Scene build_market(std::uint64_t seed);

/// Dim L-shaped corridor of 14 and 19 m, 2.4 m wide: plain walls, a few doors, noticeboards and posters.
[[nodiscard]] Scene build_corridor(std::uint64_t seed);

/// Vertical offset that puts the lowest point of `path` 0.9 m above the floor (z = 0) of its hall.
[[nodiscard]] Eigen::Vector3d hall_shift(std::span<const Eigen::Vector3d> path);

/// Furnished hall around a given camera path, free of obstacles: walls 2 m outside its bounding box.
/// @param path camera positions, not empty, already shifted by `hall_shift`
[[nodiscard]] Scene build_hall(std::uint64_t seed, std::span<const Eigen::Vector3d> path);

}  // namespace stillpoint::synth
