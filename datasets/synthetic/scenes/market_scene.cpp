// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/scenes/scenes.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector3d;
constexpr double kShelfLength_m = 9.0;
constexpr double kAisle_m = 3.2;  // distance between shelf centers

void add_shelves(const SceneContext& context) {
  for (int row = -2; row <= 2; ++row) {
    for (const double x : {-7.0, 7.0}) {
      add_market_shelf(context, {{x, row * kAisle_m, 0.0}, 0.0}, kShelfLength_m);
    }
  }
}

/// Signs above the aisles, and stacks of cartons.
void add_signs_and_stacks(const SceneContext& context) {
  const auto& [builder, palette, random] = context;
  for (int row = -2; row <= 1; ++row) {
    for (const double x : {-10.5, -3.5, 3.5, 10.5}) {
      builder.set_frame({x, (row + 0.5) * kAisle_m, 2.6}, 0.5 * std::numbers::pi);
      const int sign = pick_random(palette.posters, random);
      builder.add_textured_quad({{-0.5, -0.01, 0.5}, {1.0, 0.0, 0.0}, {0.0, 0.0, -0.5}}, sign);
      builder.add_textured_quad({{0.5, 0.01, 0.5}, {-1.0, 0.0, 0.0}, {0.0, 0.0, -0.5}}, sign);
    }
  }
  for (const double x : {-13.6, 13.6}) {
    for (double y = -8.5; y < 9.0; y += 2.4) {
      add_carton_pile(context, {{x + random.uniform(-0.2, 0.2), y, 0.0}, random.uniform(-0.4, 0.4)});
    }
  }
  for (const double y : {-4.0, 0.8, 4.3}) {
    add_carton_pile(context, {{random.uniform(-0.4, 0.4), y, 0.0}, random.uniform(-0.4, 0.4)});
  }
}

/// Closed routes around each shelf, some of them shared with the robot.
/// @param shift lateral offset from the center of the aisle [m]
std::vector<std::vector<Eigen::Vector2d>> market_routes(double lane, double shift) {
  std::vector<std::vector<Eigen::Vector2d>> routes;
  for (const double row : {0.0, 2.0, -2.0, 4.0}) {
    const double low = (row - 1.0) * lane + shift, high = (row + 1.0) * lane - shift;
    routes.push_back({{-12.4, low}, {-1.6, low}, {-1.6, high}, {-12.4, high}});
    routes.push_back({{12.4, high}, {1.6, high}, {1.6, low}, {12.4, low}});
  }
  routes.push_back({{-0.9, -8.0}, {0.9, -8.0}, {0.9, 8.0}, {-0.9, 8.0}});
  return routes;
}

}  // namespace

Scene build_market(std::uint64_t seed) {
  Scene scene;
  scene.room = Room{{-15.0, -10.0}, {15.0, 10.0}, 4.2};
  scene.gain = 0.9;
  const double lane = 0.5 * kAisle_m;
  scene.route = RobotRoute{{{-12.3, -lane},
                            {1.9, -lane},
                            {1.9, lane},
                            {12.3, lane},
                            {12.3, 3.0 * lane},
                            {-1.9, 3.0 * lane},
                            {-1.9, lane},
                            {-12.3, lane}},
                           1.2,
                           0.75,
                           0.6,
                           1.1};
  scene.walking_routes = market_routes(lane, 0.6);
  scene.cart_routes = market_routes(lane, -0.25);
  Builder builder(scene.world);
  const Palette& palette = scene.palette = make_palette(builder, seed);
  RandomSequence random(random_key(seed, RandomStream::kScene));
  const SceneContext context{builder, palette, random};
  RoomStyle style{palette.tiles, palette.paint, palette.ceiling, 1.6, 3.2, 6.0};
  add_room(context, scene.room, style);
  for (const Wall& wall : scene.room.walls()) {
    decorate(context, wall, {0.7, 0.2});
    decorate(context, wall, {0.7, 1.4});
  }
  add_shelves(context);
  add_signs_and_stacks(context);
  bake_light(scene.world, RayTracer(scene.world), seed);
  return scene;
}

Scene build_market_laps(std::uint64_t seed) {
  Scene scene = build_market(seed);
  const double lane = 0.5 * kAisle_m, cross = 1.9;
  scene.route = RobotRoute{{{-12.3, -lane},
                            {cross, -lane},
                            {cross, lane},
                            {12.3, lane},
                            {12.3, 3.0 * lane},
                            {cross, 3.0 * lane},
                            {cross, lane},
                            {-12.3, lane}},
                           1.2,
                           0.95,
                           0.6,
                           1.1};
  scene.cart_routes = scene.walking_routes;  // beside the robot's lane
  return scene;
}

}  // namespace stillpoint::synth
