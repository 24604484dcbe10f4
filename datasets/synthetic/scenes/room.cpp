// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "datasets/synthetic/scenes/furniture.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kOffWall_m = 0.015;  // distance of hung quads and skirting from the wall

}  // namespace

std::array<Wall, 4> Room::walls() const {
  const double width = high.x() - low.x(), depth = high.y() - low.y();
  return {Wall{{low.x(), high.y(), 0.0}, Vector3d::UnitX(), width},
          Wall{{high.x(), high.y(), 0.0}, -Vector3d::UnitY(), depth},
          Wall{{high.x(), low.y(), 0.0}, -Vector3d::UnitX(), width},
          Wall{{low.x(), low.y(), 0.0}, Vector3d::UnitY(), depth}};
}

void add_wall(const SceneContext& context, const Wall& wall, double height, const RoomStyle& style) {
  Builder& builder = context.builder;
  const Palette& palette = context.palette;
  constexpr double kWallRepeat_m = 2.0;
  const Vector3d up(0.0, 0.0, height), skirting(0.0, 0.0, 0.1);
  const Vector3d inward = wall.right.cross(Vector3d::UnitZ());
  builder.set_frame(Vector3d::Zero(), 0.0);
  builder.add_surface({wall.lower_left + up, wall.length * wall.right, -up}, style.wall, kWallRepeat_m);
  builder.add_surface({wall.lower_left + skirting + kOffWall_m * inward, wall.length * wall.right, -skirting},
                      palette.walnut, 1.0);
}

void add_room(const SceneContext& context, const Room& room, const RoomStyle& style) {
  add_floor_and_ceiling(context, room, style);
  for (const Wall& wall : room.walls()) add_wall(context, wall, room.height, style);
}

void add_floor_and_ceiling(const SceneContext& context, const Room& room, const RoomStyle& style) {
  Builder& builder = context.builder;
  const Palette& palette = context.palette;
  const Vector3d x(room.high.x() - room.low.x(), 0.0, 0.0), y(0.0, room.high.y() - room.low.y(), 0.0);
  constexpr double kCeilingRepeat_m = 0.6;
  builder.set_frame(Vector3d::Zero(), 0.0);
  builder.add_surface({{room.low.x(), room.high.y(), 0.0}, x, -y}, style.floor, style.floor_repeat_m);
  builder.add_surface({{room.low.x(), room.low.y(), room.height}, x, y}, style.ceiling, kCeilingRepeat_m);
  const int columns = std::max(1, static_cast<int>(std::lround(x.x() / style.lamp_spacing)));
  const int rows = std::max(1, static_cast<int>(std::lround(y.y() / style.lamp_spacing)));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const Vector3d center(room.low.x() + x.x() * (column + 0.5) / columns,
                            room.low.y() + y.y() * (row + 0.5) / rows, room.height - 0.03);
      builder.add_lamp(center, {1.2, 0.3}, style.lamp_power, palette.lamp);
    }
  }
}

std::array<Wall, 2> add_partition(const SceneContext& context, const Partition& partition, int texture) {
  constexpr double kHalfThickness_m = 0.06, kRepeat_m = 2.0;
  Builder& builder = context.builder;
  const Vector2d along = partition.to - partition.from;
  const double length = along.norm();
  const Vector3d from(partition.from.x(), partition.from.y(), 0.0);
  builder.set_frame(from, std::atan2(along.y(), along.x()));
  builder.add_box({0.0, -kHalfThickness_m, partition.bottom}, {length, kHalfThickness_m, partition.height},
                  texture, kRepeat_m);
  const Vector3d right(along.x() / length, along.y() / length, 0.0);
  const Vector3d side = kHalfThickness_m * right.cross(Vector3d::UnitZ());
  return {Wall{from + length * right - side, -right, length}, Wall{from + side, right, length}};
}

void hang(Builder& builder, const Wall& wall, const WallArea& area, int texture) {
  const auto& [at, size] = area;
  builder.set_frame(Vector3d::Zero(), 0.0);
  const Vector3d inward = wall.right.cross(Vector3d::UnitZ());
  const Vector3d corner =
      wall.lower_left + at.x() * wall.right + Vector3d(0.0, 0.0, at.y() + size.y()) + kOffWall_m * inward;
  builder.add_textured_quad({corner, size.x() * wall.right, Vector3d(0.0, 0.0, -size.y())}, texture);
}

void decorate(const SceneContext& context, const Wall& wall, const Decoration& decoration) {
  const auto& [builder, palette, random] = context;
  const double lift = decoration.lift;
  double along = random.uniform(0.2, 0.6);
  while (along < wall.length - 0.9) {
    const double gap = random.uniform(0.15, 0.5) / decoration.density;
    if (random.chance(0.2) && along + 1.8 < wall.length) {
      const int notices = pick_random(palette.noticeboards, random);
      hang(builder, wall, {{along, lift + random.uniform(1.1, 1.3)}, {1.6, 0.8}}, notices);
      along += 1.6 + gap;
    } else if (random.chance(0.75)) {
      const double width = random.uniform(0.45, 0.7);
      const int poster = pick_random(palette.posters, random);
      hang(builder, wall, {{along, lift + random.uniform(1.15, 1.4)}, {width, 1.3 * width}}, poster);
      along += width + gap;
    } else {
      const int paper = pick_random(palette.papers, random);
      hang(builder, wall, {{along, lift + random.uniform(1.3, 1.7)}, {0.21, 0.297}}, paper);
      along += 0.21 + gap;
    }
  }
}

}  // namespace stillpoint::synth
