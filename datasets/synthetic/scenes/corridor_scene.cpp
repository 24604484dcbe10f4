// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/scenes/scenes.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector3d;
constexpr double kHalfWidth_m = 1.2;
constexpr double kFirstLeg_m = 14.0;   // along x
constexpr double kSecondLeg_m = 18.0;  // along y, from the corner on
constexpr double kHeight_m = 2.5;

std::vector<Wall> corridor_walls() {
  const double inner = kFirstLeg_m - 2.0 * kHalfWidth_m;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  return {{{0.0, kHalfWidth_m, 0.0}, x, inner},
          {{kFirstLeg_m, -kHalfWidth_m, 0.0}, -x, kFirstLeg_m},
          {{0.0, -kHalfWidth_m, 0.0}, y, 2.0 * kHalfWidth_m},
          {{kFirstLeg_m, kSecondLeg_m, 0.0}, -y, kSecondLeg_m + kHalfWidth_m},
          {{inner, kHalfWidth_m, 0.0}, y, kSecondLeg_m - kHalfWidth_m},
          {{inner, kSecondLeg_m, 0.0}, x, 2.0 * kHalfWidth_m}};
}

/// Doors every few meters, and a few noticeboards, posters and bins.
void furnish_wall(const SceneContext& context, const Wall& wall) {
  const auto& [builder, palette, random] = context;
  const Vector3d inward = wall.right.cross(Vector3d::UnitZ());
  double along = random.uniform(0.4, 1.0);
  while (along + 1.0 < wall.length) {
    if (random.chance(0.4)) {
      hang(builder, wall, {{along, 0.0}, {0.95, 2.05}}, palette.door);
      hang(builder, wall, {{along + 1.1, 1.5}, {0.15, 0.2}}, pick_random(palette.papers, random));
    } else if (random.chance(0.35)) {
      hang(builder, wall, {{along, 1.1}, {1.4, 0.7}}, pick_random(palette.noticeboards, random));
    } else if (random.chance(0.6)) {
      hang(builder, wall, {{along, 1.25}, {0.5, 0.7}}, pick_random(palette.posters, random));
    } else {
      add_bin(builder, {wall.lower_left + along * wall.right + 0.2 * inward, 0.0}, palette);
    }
    along += 1.5 + random.uniform(0.0, 0.7);
  }
}

}  // namespace

Scene build_corridor(std::uint64_t seed) {
  Scene scene;
  scene.room = Room{{0.0, -kHalfWidth_m}, {kFirstLeg_m, kSecondLeg_m}, kHeight_m};
  scene.gain = 0.8;  // exposure at its limit: dark images
  const double lane = 0.45, middle = kFirstLeg_m - kHalfWidth_m;
  scene.route = RobotRoute{{{1.2, -lane},
                            {middle + lane, -lane},
                            {middle + lane, kSecondLeg_m - 1.2},
                            {middle - lane, kSecondLeg_m - 1.2},
                            {middle - lane, lane},
                            {1.2, lane}},
                           0.9,
                           0.65,
                           0.6,
                           0.95};
  scene.walking_routes = {{{3.0, 0.6},
                           {middle - 0.6, 0.6},
                           {middle - 0.6, 13.0},
                           {middle - 0.1, 13.0},
                           {middle - 0.1, 0.1},
                           {3.0, 0.1}}};
  scene.cart_routes = {{{5.0, 0.75}, {11.0, 0.75}, {11.0, 0.35}, {5.0, 0.35}}};
  Builder builder(scene.world);
  const Palette& palette = scene.palette = make_palette(builder, seed);
  RandomSequence random(random_key(seed, RandomStream::kScene));
  const SceneContext context{builder, palette, random};
  const RoomStyle style{palette.tiles, palette.plaster, palette.ceiling, 1.6, 3.0, 1.6};
  const double inner = kFirstLeg_m - 2.0 * kHalfWidth_m;
  const Room first{{0.0, -kHalfWidth_m}, {inner, kHalfWidth_m}, kHeight_m};
  const Room second{{inner, -kHalfWidth_m}, {kFirstLeg_m, kSecondLeg_m}, kHeight_m};
  for (const Room& leg : {first, second}) add_floor_and_ceiling(context, leg, style);
  for (const Wall& wall : corridor_walls()) {
    add_wall(context, wall, kHeight_m, style);
    furnish_wall(context, wall);
  }
  bake_light(scene.world, RayTracer(scene.world), seed);
  return scene;
}

Scene build_corridor_laps(std::uint64_t seed) {
  Scene scene = build_corridor(seed);
  scene.route.speed = 0.8;
  // The first corner is the sharpest: not one of a U-turn.
  std::rotate(scene.route.corners.begin(), scene.route.corners.begin() + 1, scene.route.corners.end());
  const double middle = kFirstLeg_m - kHalfWidth_m, side = 0.92;
  scene.walking_routes = {{{3.0, side}, {9.0, side}, {9.0, side - 0.02}, {3.0, side - 0.02}},
                          {{middle + side, 3.0},
                           {middle + side, 13.0},
                           {middle + side - 0.02, 13.0},
                           {middle + side - 0.02, 3.0}}};
  scene.cart_routes.clear();
  return scene;
}

}  // namespace stillpoint::synth
