// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/scenes/scenes.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
constexpr double kWallDistance_m = 2.0;
constexpr double kFloorDistance_m = 0.9;
constexpr double kCeilingDistance_m = 1.3;
constexpr double kFurnitureHeight_m = 1.25;  // a desk with a monitor
constexpr double kClearance_m = 0.5;

Room room_around(std::span<const Vector3d> path, double wall_distance_m) {
  Vector3d low = path.front(), high = path.front();
  for (const Vector3d& point : path) low = low.cwiseMin(point), high = high.cwiseMax(point);
  const Vector2d margin(wall_distance_m, wall_distance_m);
  return {low.head<2>() - margin, high.head<2>() + margin, high.z() + kCeilingDistance_m};
}

/// Whether an object of the given radius and height on the floor is at least kClearance_m from the path.
bool is_free(std::span<const Vector3d> path, const Vector2d& position, double radius, double height) {
  return std::all_of(path.begin(), path.end(), [&](const Vector3d& point) {
    return (point.head<2>() - position).norm() > radius + kClearance_m || point.z() > height + kClearance_m;
  });
}

void furnish_walls(const SceneContext& context, const Room& room) {
  RandomSequence& random = context.random;
  for (const Wall& wall : room.walls()) {
    for (double lift = -0.9; lift + 2.2 < room.height; lift += 1.05) decorate(context, wall, {1.0, lift});
    const Vector3d inward = wall.right.cross(Vector3d::UnitZ());
    const double yaw = std::atan2(wall.right.y(), wall.right.x());
    for (double along = 0.5; along + 1.6 < wall.length; along += random.uniform(2.2, 3.2)) {
      const Vector3d foot = wall.lower_left + along * wall.right + 0.33 * inward;
      if (random.chance(0.6)) {
        add_bookshelf(context, {foot, yaw}, 1.3);
      } else {
        add_carton_pile(context, {foot + 0.2 * inward, yaw});
      }
    }
  }
}

void furnish_floor(const SceneContext& context, const Room& room, std::span<const Vector3d> path) {
  RandomSequence& random = context.random;
  constexpr double kSpacing_m = 2.1;
  for (double x = room.low.x() + 1.6; x < room.high.x() - 1.4; x += kSpacing_m) {
    for (double y = room.low.y() + 1.6; y < room.high.y() - 1.4; y += kSpacing_m) {
      const double yaw = 0.5 * std::numbers::pi * random.index(4);
      const Vector3d position(x, y, 0.0);
      const Vector3d center = position + Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Vector3d(0.0, -0.4, 0.0);
      if (random.chance(0.7) && is_free(path, center.head<2>(), 0.9, kFurnitureHeight_m)) {
        add_desk(context, {position, yaw});
      } else if (is_free(path, position.head<2>(), 0.4, 1.0)) {
        add_chair(context, {position, random.uniform(0.0, 2.0 * std::numbers::pi)});
      }
    }
  }
}

/// Ducts below the ceiling, which provide corners when the camera looks up.
void add_ducts(Builder& builder, const Room& room, const Palette& palette) {
  builder.set_frame(Vector3d::Zero(), 0.0);
  for (double y = room.low.y() + 0.7; y < room.high.y() - 0.5; y += 1.9) {
    builder.add_box({room.low.x() + 0.02, y, room.height - 0.25},
                    {room.high.x() - 0.02, y + 0.22, room.height - 0.05}, palette.paint, 1.0);
    for (double x = room.low.x() + 0.6; x < room.high.x() - 0.6; x += 1.3) {
      builder.add_textured_quad({{x, y - 0.004, room.height - 0.08}, {0.2, 0.0, 0.0}, {0.0, 0.0, -0.14}},
                                palette.papers[static_cast<std::size_t>(x + 100.0) % palette.papers.size()]);
    }
  }
}

/// Parts of the line between two points that are at least kPartitionClearance_m from all points of `path`.
std::vector<Partition> free_parts(const Vector2d& from, const Vector2d& to, std::span<const Vector3d> path) {
  constexpr double kPartitionClearance_m = 0.75, kStep_m = 0.1, kMinLength_m = 0.6;
  const double length = (to - from).norm();
  const Vector2d along = (to - from) / length;
  std::vector<Partition> parts;
  double start = -1.0;
  for (double at = 0.0; at <= length + kStep_m; at += kStep_m) {
    const Vector2d point = from + at * along;
    const bool free = at <= length && std::all_of(path.begin(), path.end(), [&](const Vector3d& other) {
                        return (other.head<2>() - point).norm() > kPartitionClearance_m;
                      });
    if (free && start < 0.0) start = at;
    if (free || start < 0.0) continue;
    if (at - kStep_m - start > kMinLength_m) {
      parts.push_back({from + start * along, from + (at - kStep_m) * along});
    }
    start = -1.0;
  }
  return parts;
}

/// Partitions on a grid of rooms of about 3 m, wherever the path leaves space.
/// @return points on their center lines
std::vector<Vector3d> add_partitions(const SceneContext& context, const Room& room,
                                     std::span<const Vector3d> path) {
  constexpr double kRoom_m = 3.0;
  std::vector<Partition> partitions;
  const Vector2d size = room.high - room.low;
  for (const int axis : {0, 1}) {
    const int rooms = static_cast<int>(std::lround(size[axis] / kRoom_m));
    for (int i = 1; i < rooms; ++i) {
      Vector2d from = room.low, to = room.high;
      from[axis] = to[axis] = room.low[axis] + i * size[axis] / rooms;
      for (Partition& part : free_parts(from, to, path)) partitions.push_back(part);
    }
  }
  std::vector<Vector3d> points;
  for (Partition& partition : partitions) {
    partition.height = room.height;
    for (const Wall& wall : add_partition(context, partition, context.palette.plaster)) {
      if (wall.length > 1.2) decorate(context, wall, {0.8, 0.0});
    }
    for (double share = 0.0; share <= 1.0; share += 0.05) {
      const Vector2d point = partition.from + share * (partition.to - partition.from);
      points.emplace_back(point.x(), point.y(), 0.0);
    }
  }
  return points;
}

}  // namespace

Vector3d hall_shift(std::span<const Vector3d> path) {
  const auto lowest = std::min_element(path.begin(), path.end(),
                                       [](const Vector3d& a, const Vector3d& b) { return a.z() < b.z(); });
  return {0.0, 0.0, kFloorDistance_m - lowest->z()};
}

Scene build_hall(std::uint64_t seed, std::span<const Vector3d> path) {
  Scene scene;
  scene.room = room_around(path, kWallDistance_m);
  scene.gain = 1.5;
  Builder builder(scene.world);
  const Palette& palette = scene.palette = make_palette(builder, seed);
  RandomSequence random(random_key(seed, RandomStream::kScene));
  const SceneContext context{builder, palette, random};
  add_room(context, scene.room, {palette.carpet, palette.plaster, palette.ceiling});
  furnish_walls(context, scene.room);
  furnish_floor(context, scene.room, path);
  add_ducts(builder, scene.room, palette);
  bake_light(scene.world, RayTracer(scene.world), seed);
  return scene;
}

Scene build_home(std::uint64_t seed, std::span<const Vector3d> path,
                 const std::vector<std::vector<Vector2d>>& walking_routes) {
  constexpr double kHomeWallDistance_m = 1.4, kHomeHeight_m = 2.6, kRouteStep = 0.05;
  Scene scene;
  scene.room = room_around(path, kHomeWallDistance_m);
  scene.room.height = kHomeHeight_m;
  scene.gain = 1.4;
  scene.walking_routes = walking_routes;
  Builder builder(scene.world);
  const Palette& palette = scene.palette = make_palette(builder, seed);
  RandomSequence random(random_key(seed, RandomStream::kScene));
  const SceneContext context{builder, palette, random};
  std::vector<Vector3d> occupied(path.begin(), path.end());
  for (const std::vector<Vector2d>& route : walking_routes) {
    for (std::size_t i = 0; i < route.size(); ++i) {
      for (double share = 0.0; share < 1.0; share += kRouteStep) {
        const Vector2d point = route[i] + share * (route[(i + 1) % route.size()] - route[i]);
        occupied.emplace_back(point.x(), point.y(), 0.0);
      }
    }
  }
  add_room(context, scene.room, {palette.oak, palette.plaster, palette.ceiling});
  furnish_walls(context, scene.room);
  const std::vector<Vector3d> partitions = add_partitions(context, scene.room, occupied);
  occupied.insert(occupied.end(), partitions.begin(), partitions.end());
  furnish_floor(context, scene.room, occupied);
  bake_light(scene.world, RayTracer(scene.world), seed);
  return scene;
}

}  // namespace stillpoint::synth
