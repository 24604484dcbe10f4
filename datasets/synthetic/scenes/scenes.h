// SPDX-License-Identifier: BSD-3-Clause
/// The synthetic scenes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "datasets/synthetic/motion/camera_motion.h"
#include "datasets/synthetic/render/world.h"
#include "datasets/synthetic/scenes/furniture.h"

namespace stillpoint::synth {

/// A change of the static world while the camera does not see it.
struct SceneChange {
  World world;  ///< with the same textures as before the change
  /// Part of the floor; the change takes place when the camera first enters it.
  Eigen::Vector2d away_low = Eigen::Vector2d::Zero(), away_high = Eigen::Vector2d::Zero();
};

/// A static world with its baked lightmap, and the routes of camera, people and other moving objects.
struct Scene {
  World world;
  Room room;
  Viewpoint viewpoint;                                       ///< mean pose of a hand-held camera
  RobotRoute route;                                          ///< route of a robot-mounted camera
  std::vector<std::vector<Eigen::Vector2d>> walking_routes;  ///< closed polygons for people
  std::vector<std::vector<Eigen::Vector2d>> cart_routes;     ///< closed polygons for carts and chairs
  std::vector<Placement> seats;                              ///< free chairs
  double floor_m = 0.0;  ///< height on which people and other moving objects move
  Palette palette;
  double gain = 1.0;  ///< from scene radiance to sensor signal (1 = saturation)
  std::optional<SceneChange> change;
};

/// Furnished office of 8 x 7 m with four desks, as in the TUM freiburg3 sequences.
[[nodiscard]] Scene build_office(std::uint64_t seed);

/// Office of 11 x 9 m with an island of four desks, around which a robot drives.
[[nodiscard]] Scene build_large_office(std::uint64_t seed);

/// Market hall of 30 x 20 m with rows of shelves.
[[nodiscard]] Scene build_market(std::uint64_t seed);

/// The market with a route of 50 m that keeps away from cartons, and carts that keep away from the route.
[[nodiscard]] Scene build_market_laps(std::uint64_t seed);

/// Dim L-shaped corridor of 14 and 19 m, 2.4 m wide: plain walls, a few doors, noticeboards and posters.
[[nodiscard]] Scene build_corridor(std::uint64_t seed);

/// The corridor with a faster robot, and people who walk along a wall where they leave space for it.
[[nodiscard]] Scene build_corridor_laps(std::uint64_t seed);

/// Hall with two aisles between shelves that are equal up to a translation by `kTwinShift_m` along y
/// (perceptual aliasing). Signs above their ends, the walls of the hall and the light of distant lamps
/// differ. The robot drives through both in the same direction, and back between them.
/// @param aisle_length of the shelves [m]
[[nodiscard]] Scene build_twin_aisles(std::uint64_t seed, double aisle_length);
inline constexpr double kTwinShift_m = 7.2;

/// Two rooms of 6 x 6 m with a door between them, at x = 0. While the robot is in the second (x > 0),
/// furniture of the first is moved by 0.4 m or more, and half of its lamps are switched off.
[[nodiscard]] Scene build_changed_room(std::uint64_t seed);

/// Vertical offset that puts the lowest point of `path` 0.9 m above the floor (z = 0) of its hall.
[[nodiscard]] Eigen::Vector3d hall_shift(std::span<const Eigen::Vector3d> path);

/// Furnished hall around a given camera path, free of obstacles: walls 2 m outside its bounding box.
/// @param path camera positions, not empty, already shifted by `hall_shift`
[[nodiscard]] Scene build_hall(std::uint64_t seed, std::span<const Eigen::Vector3d> path);

/// Home of several rooms around a given camera path: partitions where the path leaves space for them.
/// @param path camera positions, not empty
/// @param walking_routes of people; free of furniture
[[nodiscard]] Scene build_home(std::uint64_t seed, std::span<const Eigen::Vector3d> path,
                               const std::vector<std::vector<Eigen::Vector2d>>& walking_routes);

}  // namespace stillpoint::synth
