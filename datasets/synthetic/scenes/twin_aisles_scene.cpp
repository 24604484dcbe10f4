// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/scenes/scenes.h"

namespace stillpoint::synth {
namespace {

constexpr double kAisleWidth_m = 3.2;                 // distance between the two shelves of an aisle
constexpr double kFirstLane_m = -0.5 * kTwinShift_m;  // y of the first aisle
constexpr double kEnd_m = 2.4;                        // floor between the shelves' ends and the walls

/// Copies the quads from `first` on, shifted to the second aisle.
void repeat_in_second_aisle(World& world, std::size_t first) {
  const std::size_t end = world.quads.size();
  for (std::size_t i = first; i < end; ++i) {
    Quad twin = world.quads[i];
    twin.origin.y() += static_cast<float>(kTwinShift_m);
    world.quads.push_back(twin);
  }
}

/// Different signs above both ends of an aisle.
void add_signs(const SceneContext& context, double lane, double half_length) {
  const auto& [builder, palette, random] = context;
  for (const double x : {-half_length, half_length}) {
    builder.set_frame({x, lane, 2.6}, 0.5 * std::numbers::pi);
    const int sign = pick_random(palette.posters, random);
    builder.add_textured_quad({{-0.5, -0.01, 0.5}, {1.0, 0.0, 0.0}, {0.0, 0.0, -0.5}}, sign);
    builder.add_textured_quad({{0.5, 0.01, 0.5}, {-1.0, 0.0, 0.0}, {0.0, 0.0, -0.5}}, sign);
  }
}

void add_aisles(const SceneContext& context, double aisle_length) {
  World& world = context.builder.world();
  const std::size_t first = world.quads.size();
  for (const double side : {-0.5, 0.5}) {
    add_market_shelf(context, {{0.0, kFirstLane_m + side * kAisleWidth_m, 0.0}, 0.0}, aisle_length);
  }
  repeat_in_second_aisle(world, first);
}

/// East through the first aisle, west between the aisles, east through the second, and west again.
RobotRoute route_through(double half_length) {
  const double end = half_length + 0.5 * kEnd_m, a = kFirstLane_m, b = a + kTwinShift_m;
  return RobotRoute{
      {{-end, a}, {end, a}, {end, -0.35}, {-end, -0.35}, {-end, b}, {end, b}, {end, 0.35}, {-end, 0.35}},
      0.9,
      0.9,
      0.6,
      1.1};
}

}  // namespace

Scene build_twin_aisles(std::uint64_t seed, double aisle_length) {
  const double half_length = 0.5 * aisle_length;
  Scene scene;
  // Tiles (1.8 m), ceiling tiles (0.6 m) and lamps (3.6 m) repeat after kTwinShift_m.
  scene.room = Room{{-half_length - kEnd_m, -kTwinShift_m}, {half_length + kEnd_m, kTwinShift_m}, 3.6};
  scene.gain = 0.9;
  scene.route = route_through(half_length);
  const double x = half_length - 0.4;
  scene.walking_routes = {{{-x, 0.95}, {x, 0.95}, {x, 1.1}, {-x, 1.1}},
                          {{-x, -0.95}, {-x, -1.1}, {x, -1.1}, {x, -0.95}}};
  scene.cart_routes = scene.walking_routes;
  Builder builder(scene.world);
  const Palette& palette = scene.palette = make_palette(builder, seed);
  RandomSequence random(random_key(seed, RandomStream::kScene));
  const SceneContext context{builder, palette, random};
  add_room(context, scene.room, {palette.tiles, palette.paint, palette.ceiling, 1.8, 3.6, 4.0});
  for (const Wall& wall : scene.room.walls()) decorate(context, wall, {0.7, 0.2});
  add_aisles(context, aisle_length);
  for (const double lane : {kFirstLane_m, kFirstLane_m + kTwinShift_m}) add_signs(context, lane, half_length);
  bake_light(scene.world, RayTracer(scene.world), seed);
  return scene;
}

}  // namespace stillpoint::synth
