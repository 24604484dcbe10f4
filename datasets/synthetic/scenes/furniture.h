// SPDX-License-Identifier: BSD-3-Clause
/// Rooms and furniture of the synthetic scenes, and the palette of textures that they share.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/render/world.h"

namespace stillpoint::synth {

/// Texture numbers shared by all scenes.
struct Palette {
  int carpet = 0, tiles = 0, plaster = 0, ceiling = 0, lamp = 0;
  int oak = 0, walnut = 0, metal = 0, dark_plastic = 0, light_plastic = 0, paint = 0, carton = 0, door = 0,
      window = 0;
  std::vector<int> fabrics, posters, noticeboards, papers, screens, keyboards, spines, packages, plain_colors;
};

[[nodiscard]] Palette make_palette(Builder& builder, std::uint64_t seed);

/// What the functions below add to, and draw from.
struct SceneContext {
  Builder& builder;
  const Palette& palette;
  RandomSequence& random;
};

/// One of `textures`, at random.
[[nodiscard]] int pick_random(const std::vector<int>& textures, RandomSequence& random);

/// A wall seen from inside the room.
struct Wall {
  Eigen::Vector3d lower_left;  ///< corner as seen from inside the room
  Eigen::Vector3d right;       ///< unit vector towards the right end
  double length = 0.0;         ///< [m]
};

/// A rectangular room.
struct Room {
  Eigen::Vector2d low, high;  ///< [m]
  double height = 3.0;        ///< [m]

  /// In the order +y, +x, -y, -x.
  [[nodiscard]] std::array<Wall, 4> walls() const;
};

/// Floor, walls, ceiling and a grid of lamps.
struct RoomStyle {
  int floor, wall, ceiling;
  double floor_repeat_m = 2.0;  ///< size of one repeat of the floor texture
  double lamp_spacing = 2.6;    ///< distance between lamps [m]
  double lamp_power = 1.9;
};
void add_room(const SceneContext& context, const Room& room, const RoomStyle& style);
/// Parts of a room, for non-rectangular floor plans.
void add_floor_and_ceiling(const SceneContext& context, const Room& room, const RoomStyle& style);
void add_wall(const SceneContext& context, const Wall& wall, double height, const RoomStyle& style);

/// A rectangle on a wall.
struct WallArea {
  Eigen::Vector2d at;  ///< lower left corner: (distance along the wall, height) [m]
  Eigen::Vector2d size;
};

/// Hangs a textured rectangle on a wall.
void hang(Builder& builder, const Wall& wall, const WallArea& area, int texture);

/// A thin wall inside of a room, from the floor to `height`.
struct Partition {
  Eigen::Vector2d from, to;  ///< ends of the center line, distinct
  double height = 2.5;       ///< [m]
  double bottom = 0.0;       ///< height of the lower edge, e.g. of a lintel [m]
};

/// Adds a wall of 12 cm; its two sides are in the order left and right as seen along from - to.
/// @return both sides, to be decorated
std::array<Wall, 2> add_partition(const SceneContext& context, const Partition& partition, int texture);

/// Wall decoration: gaps are proportional to 1 / density; the row is `lift` [m] above eye level.
struct Decoration {
  double density = 1.0;  ///< > 0
  double lift = 0.0;
};

/// Hangs a row of posters, noticeboards and sheets of paper.
void decorate(const SceneContext& context, const Wall& wall, const Decoration& decoration);

/// Pose of a piece of furniture on the floor; the front points to -y before the rotation by `yaw` [rad].
struct Placement {
  Eigen::Vector3d position;
  double yaw = 0.0;
};
void add_desk(const SceneContext& context, const Placement& placement);
void add_chair(const SceneContext& context, const Placement& placement);
void add_bookshelf(const SceneContext& context, const Placement& placement, double width);
/// A shelf with packages on both sides. @param length along x [m]
void add_market_shelf(const SceneContext& context, const Placement& placement, double length);
void add_carton_pile(const SceneContext& context, const Placement& placement);
void add_bin(Builder& builder, const Placement& placement, const Palette& palette);

}  // namespace stillpoint::synth
