// SPDX-License-Identifier: BSD-3-Clause
/// Things that furnish the synthetic scenes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "datasets/synthetic/counter_random.h"
#include "datasets/synthetic/world.h"

namespace stillpoint {

/// Textures that scenes share, by their numbers in the world.
struct Palette {
  int carpet = 0, tiles = 0, plaster = 0, ceiling = 0, lamp = 0;
  int oak = 0, walnut = 0, metal = 0, dark_plastic = 0, light_plastic = 0, paint = 0, carton = 0, door = 0,
      window = 0;
  std::vector<int> fabrics, posters, boards, papers, screens, keyboards, spines, packages, plains;
};

[[nodiscard]] Palette make_palette(Builder& builder, std::uint64_t seed);

/// One of `textures`, at random.
[[nodiscard]] int any_of(const std::vector<int>& textures, RandomSequence& random);

/// A wall as seen from inside the room.
struct Wall {
  Eigen::Vector3d left_foot;  ///< its lower left corner
  Eigen::Vector3d right;      ///< unit, towards its right end
  double length = 0.0;        ///< [m]
};

/// A rectangular room.
struct Room {
  Eigen::Vector2d low, high;  ///< [m]
  double height = 3.0;        ///< [m]

  /// In the order +y, +x, -y, -x.
  [[nodiscard]] std::array<Wall, 4> walls() const;
};

/// Floor, walls, ceiling and a grid of lamps.
struct RoomLook {
  int floor, wall, ceiling;
  double floor_metres = 2.0;   ///< width of one repeat of the floor's picture
  double lamp_distance = 2.6;  ///< between lamps [m]
  double lamp_power = 1.9;
};
void add_room(Builder& builder, const Room& room, const RoomLook& look, const Palette& palette);
/// The parts of a room, for places that are no rectangle.
void add_floor_and_ceiling(Builder& builder, const Room& room, const RoomLook& look, const Palette& palette);
void add_wall(Builder& builder, const Wall& wall, double height, const RoomLook& look,
              const Palette& palette);

/// Hangs a picture with its lower left corner at (along, up) on a wall.
void hang(Builder& builder, const Wall& wall, const Eigen::Vector2d& at, const Eigen::Vector2d& size,
          int texture);

/// How much hangs on a wall: gaps shrink as the density grows; the row is raised by `lift` [m] from eye
/// level.
struct Decoration {
  double density = 1.0;  ///< > 0
  double lift = 0.0;
};

/// Hangs a row of posters, noticeboards and sheets.
void decorate(Builder& builder, const Wall& wall, const Decoration& decoration, const Palette& palette,
              RandomSequence& random);

/// Each stands at `place`, its front towards -y before it is turned by `yaw`.
struct Place {
  Eigen::Vector3d position;
  double yaw = 0.0;
};
void add_desk(Builder& builder, const Place& place, const Palette& palette, RandomSequence& random);
void add_chair(Builder& builder, const Place& place, const Palette& palette, RandomSequence& random);
void add_bookshelf(Builder& builder, const Place& place, double width, const Palette& palette,
                   RandomSequence& random);
/// Goods on both sides. @param length along x [m]
void add_market_shelf(Builder& builder, const Place& place, double length, const Palette& palette,
                      RandomSequence& random);
void add_carton_pile(Builder& builder, const Place& place, const Palette& palette, RandomSequence& random);
void add_bin(Builder& builder, const Place& place, const Palette& palette);

}  // namespace stillpoint
