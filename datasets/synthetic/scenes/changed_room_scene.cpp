// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/scenes/scenes.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSize_m = 6.0;  // of both rooms
constexpr double kHalfSize_m = 0.5 * kSize_m;
constexpr double kRoomHeight_m = 2.7;
constexpr double kDoor_m = 1.0;  // half width of the opening
constexpr double kDoorHeight_m = 2.1;

enum class Visit { kFirst, kSecond };

/// Random numbers of one group of objects: the other groups do not depend on it.
RandomSequence group_random(std::uint64_t seed, std::uint64_t group) {
  return RandomSequence(random_key(seed, RandomStream::kScene, 100 + group));
}

/// What both visits share: walls with a door between the rooms, posters, and two bookshelves per room.
void add_unchanged(Builder& builder, const Palette& palette, std::uint64_t seed) {
  RandomSequence random = group_random(seed, 0);
  const SceneContext context{builder, palette, random};
  const Room both{{-kSize_m, -kHalfSize_m}, {kSize_m, kHalfSize_m}, kRoomHeight_m};
  const RoomStyle style{palette.carpet, palette.plaster, palette.ceiling};
  for (const Wall& wall : both.walls()) {
    add_wall(context, wall, kRoomHeight_m, style);
    decorate(context, wall, {0.8, 0.0});
  }
  for (const double side : {-1.0, 1.0}) {
    const Partition beside_door{{0.0, side * kDoor_m}, {0.0, side * kHalfSize_m}, kRoomHeight_m};
    for (const Wall& wall : add_partition(context, beside_door, palette.plaster)) decorate(context, wall, {});
    add_bookshelf(context, {{side * 4.2 - 0.8, kHalfSize_m - 0.32, 0.0}, 0.0}, 1.3);
    add_bookshelf(context, {{side * (kSize_m - 0.32), -0.6 * side, 0.0}, -0.5 * side * std::numbers::pi},
                  1.2);
  }
  add_partition(context, {{0.0, -kDoor_m}, {0.0, kDoor_m}, kRoomHeight_m, kDoorHeight_m}, palette.plaster);
}

/// An island of two desks with chairs, and cartons at the wall.
/// @param center x of the room's center
/// @param moved  of desks, chairs and cartons [m]
void furnish_room(const SceneContext& context, double center, const Vector2d& moved) {
  const Vector3d shift(center + moved.x(), moved.y(), 0.0);
  add_desk(context, {Vector3d(0.0, 0.0, 0.0) + shift, 0.0});
  add_desk(context, {Vector3d(0.0, 0.02, 0.0) + shift, std::numbers::pi});
  add_chair(context, {Vector3d(-0.5 - moved.x(), -0.75, 0.0) + shift, std::numbers::pi + 0.3 + moved.x()});
  add_carton_pile(context, {{center - 0.6 + 2.0 * moved.x(), -kHalfSize_m + 0.45, 0.0}, 0.2});
  add_carton_pile(context, {{center + 1.8 - 2.5 * moved.x(), -kHalfSize_m + 0.4, 0.0}, -0.2 + moved.x()});
}

void add_floor(const SceneContext& context, double center, double lamp_power) {
  const Palette& palette = context.palette;
  const Room room{{center - kHalfSize_m, -kHalfSize_m}, {center + kHalfSize_m, kHalfSize_m}, kRoomHeight_m};
  add_floor_and_ceiling(context, room,
                        {palette.carpet, palette.plaster, palette.ceiling, 2.0, 3.0, lamp_power});
}

void switch_off_south_lamps(World& world) {
  for (Lamp& lamp : world.lamps) {
    if (lamp.center.y() < 0.0F) lamp.power = 0.0F;
  }
  for (Quad& quad : world.quads) {
    if (quad.origin.y() < 0.0F) quad.emissive = false;  // lamps are the only emissive quads so far
  }
}

/// Two of the four lamps of the first room are off at the second visit, and furniture has been moved.
void add_first_room(Builder& builder, const Palette& palette, std::uint64_t seed, Visit visit) {
  RandomSequence random = group_random(seed, 1);
  const SceneContext context{builder, palette, random};
  add_floor(context, -kHalfSize_m, 2.2);
  if (visit == Visit::kSecond) switch_off_south_lamps(builder.world());
  furnish_room(context, -kHalfSize_m, visit == Visit::kFirst ? Vector2d(0.0, 0.0) : Vector2d(0.4, 0.25));
}

World build_rooms(std::uint64_t seed, Visit visit) {
  World world;
  Builder builder(world);
  const Palette palette = make_palette(builder, seed);
  add_unchanged(builder, palette, seed);
  add_first_room(builder, palette, seed, visit);
  RandomSequence random = group_random(seed, 2);
  const SceneContext context{builder, palette, random};
  add_floor(context, kHalfSize_m, 2.2);
  furnish_room(context, kHalfSize_m, Vector2d::Zero());
  bake_light(world, RayTracer(world), seed);
  return world;
}

}  // namespace

Scene build_changed_room(std::uint64_t seed) {
  Scene scene;
  scene.room = Room{{-kSize_m, -kHalfSize_m}, {kSize_m, kHalfSize_m}, kRoomHeight_m};
  scene.gain = 1.2;
  // Around the island of the first room, through the door, around that of the second, and back.
  scene.route = RobotRoute{{{-4.75, 1.75},
                            {-4.75, -1.75},
                            {-1.25, -1.75},
                            {-1.25, -0.35},
                            {1.25, -0.35},
                            {1.25, -1.75},
                            {4.75, -1.75},
                            {4.75, 1.75},
                            {1.25, 1.75},
                            {1.25, 0.35},
                            {-1.25, 0.35},
                            {-1.25, 1.75}},
                           0.6,
                           0.8,
                           0.7,
                           1.1};
  scene.walking_routes = {{{1.6, 2.25}, {4.9, 2.25}, {4.9, 2.4}, {1.6, 2.4}},
                          {{-4.9, 2.25}, {-1.6, 2.25}, {-1.6, 2.4}, {-4.9, 2.4}}};
  scene.cart_routes = scene.walking_routes;
  scene.world = build_rooms(seed, Visit::kFirst);
  World unused;
  Builder builder(unused);
  scene.palette = make_palette(builder, seed);
  scene.change = SceneChange{build_rooms(seed, Visit::kSecond), {4.2, -1.2}, {kSize_m, 1.75}};
  return scene;
}

}  // namespace stillpoint::synth
