// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>

#include "datasets/synthetic/render/lightmap.h"
#include "datasets/synthetic/scenes/scenes.h"

namespace stillpoint::synth {
namespace {

using Eigen::Vector3d;

/// Chairs at the desks, in the order in which seated people occupy them.
const std::vector<Placement> kSeats{
    {{-0.62, -0.98, 0.0}, std::numbers::pi + 0.3}, {{0.75, 1.2, 0.0}, -0.2}, {{-0.8, 1.25, 0.0}, 0.35}};

void add_workplaces(const SceneContext& context) {
  const auto& [builder, palette, random] = context;
  for (const double x : {-0.82, 0.82}) {
    add_desk(context, {{x, 0.0, 0.0}, 0.0});
    add_desk(context, {{x, 0.04, 0.0}, std::numbers::pi});
    add_chair(context, {{x + random.uniform(-0.2, 0.2), 1.25, 0.0}, random.uniform(-0.5, 0.5)});
  }
  add_chair(context, {{-1.1, -1.15, 0.0}, std::numbers::pi + random.uniform(-0.6, 0.6)});
  builder.set_frame(Vector3d::Zero(), 0.0);
  builder.add_box({-1.62, 0.0, 0.5}, {1.62, 0.04, 1.02}, palette.fabrics[1], 0.5);
}

void add_walls(const SceneContext& context, const Room& room) {
  Builder& builder = context.builder;
  const Palette& palette = context.palette;
  const auto walls = room.walls();
  for (std::size_t i : {0U, 2U, 3U}) decorate(context, walls[i], {});
  for (const double along : {0.6, 2.6, 4.6})
    hang(builder, walls[1], {{along, 0.9}, {1.5, 1.5}}, palette.window);
  hang(builder, walls[2], {{6.2, 0.0}, {1.0, 2.1}}, palette.door);
}

void add_furniture_at_walls(const SceneContext& context, const Room& room) {
  Builder& builder = context.builder;
  const Palette& palette = context.palette;
  const double north = room.high.y() - 0.32;
  add_bookshelf(context, {{-3.4, north, 0.0}, 0.0}, 1.2);
  add_bookshelf(context, {{1.6, north, 0.0}, 0.0}, 1.6);
  add_bookshelf(context, {{room.low.x() + 0.32, -1.2, 0.0}, std::numbers::pi / 2.0}, 1.6);
  add_carton_pile(context, {{-1.4, room.high.y() - 0.45, 0.0}, 0.2});
  add_carton_pile(context, {{3.3, -2.9, 0.0}, -0.3});
  add_carton_pile(context, {{3.5, 2.2, 0.0}, 0.5});
  add_bin(builder, {{2.0, 0.5, 0.0}, 0.0}, palette);
  add_bin(builder, {{-2.1, -0.6, 0.0}, 0.0}, palette);
  add_desk(context, {{3.98, -0.2, 0.0}, -std::numbers::pi / 2.0});
  add_chair(context, {{2.85, -0.2, 0.0}, std::numbers::pi / 2.0 + 0.3});
}

/// Furniture of the large office: at its walls, at least 0.9 m from the robot's route.
void add_furniture_of_large_office(const SceneContext& context, const Room& room) {
  Builder& builder = context.builder;
  const Palette& palette = context.palette;
  const double north = room.high.y() - 0.32, south = room.low.y() + 0.32;
  for (const double x : {-4.6, -1.0, 2.4}) add_bookshelf(context, {{x, north, 0.0}, 0.0}, 1.6);
  for (const double x : {4.2, 1.4}) add_bookshelf(context, {{x, south, 0.0}, std::numbers::pi}, 1.3);
  add_bookshelf(context, {{room.low.x() + 0.32, -1.2, 0.0}, std::numbers::pi / 2.0}, 1.6);
  for (const double x : {-2.4, 1.4}) add_carton_pile(context, {{x, room.high.y() - 0.45, 0.0}, 0.2});
  add_carton_pile(context, {{-3.4, room.low.y() + 0.5, 0.0}, -0.3});
  add_desk(context, {{room.high.x() - 0.02, -0.2, 0.0}, -std::numbers::pi / 2.0});
  add_desk(context, {{room.high.x() - 0.02, 2.2, 0.0}, -std::numbers::pi / 2.0});
  add_bin(builder, {{1.85, 0.5, 0.0}, 0.0}, palette);
  add_bin(builder, {{-1.9, -0.6, 0.0}, 0.0}, palette);
}

}  // namespace

Scene build_large_office(std::uint64_t seed) {
  Scene scene;
  scene.room = Room{{-5.5, -4.5}, {5.5, 4.5}, 2.9};
  scene.gain = 1.5;
  scene.seats = kSeats;
  scene.route = RobotRoute{{{-3.0, -2.4}, {3.0, -2.4}, {3.0, 2.4}, {-3.0, 2.4}}, 0.9, 0.8, 0.6, 1.1};
  // Around the robot's route, and across it.
  scene.walking_routes = {{{-3.9, -3.3}, {3.9, -3.3}, {3.9, 3.3}, {-3.9, 3.3}},
                          {{2.2, 3.3}, {2.2, -3.3}, {3.8, -3.3}, {3.8, 3.3}},
                          {{-3.7, 1.8}, {3.7, 1.8}, {3.7, 3.2}, {-3.7, 3.2}}};
  scene.cart_routes = {{{-3.6, -3.4}, {3.6, -3.4}, {3.6, -3.2}, {-3.6, -3.2}}};
  Builder builder(scene.world);
  const Palette& palette = scene.palette = make_palette(builder, seed);
  RandomSequence random(random_key(seed, RandomStream::kScene));
  const SceneContext context{builder, palette, random};
  add_room(context, scene.room, {palette.carpet, palette.plaster, palette.ceiling});
  add_walls(context, scene.room);
  add_furniture_of_large_office(context, scene.room);
  add_workplaces(context);
  bake_light(scene.world, RayTracer(scene.world), seed);
  return scene;
}

Scene build_office(std::uint64_t seed) {
  Scene scene;
  scene.room = Room{{-4.0, -3.5}, {4.0, 3.5}, 2.9};
  scene.viewpoint = Viewpoint{{0.1, -2.55, 1.6}, {0.0, 0.1, 0.95}};
  scene.gain = 1.5;
  scene.seats = kSeats;
  // The first routes pass close in front of the camera, as in the TUM walking sequences, where people fill a
  // third of the image most of the time.
  scene.walking_routes = {{{-0.9, -1.4}, {0.9, -1.4}, {0.9, -1.65}, {-0.9, -1.65}},
                          {{-0.3, -1.15}, {1.4, -1.15}, {1.4, -0.95}, {-0.3, -0.95}},
                          {{2.4, 2.0}, {-2.2, 2.1}, {-2.6, 2.8}, {2.3, 2.6}},
                          {{2.2, -1.5}, {2.2, 2.4}, {2.6, 2.4}, {2.6, -1.6}}};
  scene.cart_routes = {{{-0.8, -1.1}, {0.9, -1.1}, {0.9, -1.3}, {-0.8, -1.3}},
                       {{-2.4, 1.8}, {2.2, 1.9}, {2.2, 2.4}, {-2.4, 2.3}}};
  Builder builder(scene.world);
  const Palette& palette = scene.palette = make_palette(builder, seed);
  RandomSequence random(random_key(seed, RandomStream::kScene));
  const SceneContext context{builder, palette, random};
  add_room(context, scene.room, {palette.carpet, palette.plaster, palette.ceiling});
  add_walls(context, scene.room);
  add_furniture_at_walls(context, scene.room);
  add_workplaces(context);
  bake_light(scene.world, RayTracer(scene.world), seed);
  return scene;
}

}  // namespace stillpoint::synth
