// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/scenes/furniture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/synthetic/materials/surfaces.h"

namespace stillpoint::synth {
namespace {

template <class Paint>
std::vector<int> add_textures(Builder& builder, int count, const Paint& paint, RandomSequence& random) {
  std::vector<int> numbers;
  numbers.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) numbers.push_back(builder.add_texture(paint(random)));
  return numbers;
}

}  // namespace

Palette make_palette(Builder& builder, std::uint64_t seed) {
  RandomSequence random(random_key(seed, RandomStream::kTexture));
  const auto add = [&builder](const cv::Mat& texture) { return builder.add_texture(texture); };
  Palette palette;
  palette.carpet = add(paint_carpet(Color(128, 132, 142), random));
  palette.tiles = add(paint_tiles(Color(185, 178, 165), 4, random));
  palette.plaster = add(paint_plaster(Color(205, 203, 196), random));
  palette.ceiling = add(paint_ceiling(random));
  palette.lamp = add(blank_canvas(4, 4, Color(255, 255, 250)));
  palette.oak = add(paint_wood(Color(190, 155, 112), random));
  palette.walnut = add(paint_wood(Color(120, 88, 62), random));
  palette.metal = add(paint_plain(Color(165, 168, 172), 8.0, random));
  palette.dark_plastic = add(paint_plain(Color(58, 58, 62), 8.0, random));
  palette.light_plastic = add(paint_plain(Color(205, 203, 195), 6.0, random));
  palette.paint = add(paint_plaster(Color(170, 180, 185), random));
  palette.carton = add(paint_carton(random));
  palette.door = add(paint_door(Color(150, 112, 78), random));
  palette.window = add(paint_window(random));
  const auto fabric = [](RandomSequence& r) { return paint_fabric(random_color(r, 140.0, 0.6), r); };
  const auto plain = [](RandomSequence& r) { return paint_plain(random_color(r, 200.0, 0.7), 10.0, r); };
  palette.fabrics = add_textures(builder, 4, fabric, random);
  palette.posters = add_textures(builder, 10, paint_poster, random);
  palette.noticeboards = add_textures(builder, 2, paint_noticeboard, random);
  palette.papers = add_textures(builder, 6, paint_paper, random);
  palette.screens = add_textures(builder, 4, paint_screen, random);
  palette.keyboards = add_textures(builder, 1, paint_keyboard, random);
  palette.spines = add_textures(builder, 3, paint_book_spines, random);
  palette.packages = add_textures(builder, 3, paint_packages, random);
  palette.plain_colors = add_textures(builder, 6, plain, random);
  return palette;
}

int pick_random(const std::vector<int>& textures, RandomSequence& random) {
  return textures[static_cast<std::size_t>(random.index(static_cast<int>(textures.size())))];
}

namespace {

using Eigen::Vector3d;

constexpr double kDeskHeight = 0.73;

/// A rectangle on a horizontal plane.
struct Sheet {
  double yaw = 0.0;
  Vector3d center;
  double width = 0.0;
  double depth = 0.0;
};

/// A sheet or keyboard on a horizontal plane, rotated by `yaw` in the current frame.
void lay_flat(Builder& builder, const Sheet& sheet, int texture) {
  const auto& [yaw, center, width, depth] = sheet;
  const Vector3d right = width * Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
  const Vector3d down = depth * Vector3d(std::sin(yaw), -std::cos(yaw), 0.0);
  builder.add_textured_quad({center - 0.5 * right - 0.5 * down, right, down}, texture);
}

void add_monitor(const SceneContext& context, const Vector3d& foot) {
  const auto& [builder, palette, random] = context;
  constexpr double kHalfWidth = 0.27, kHeight = 0.34, kThickness = 0.04;
  builder.add_box(foot + Vector3d(-0.12, -0.09, 0.0), foot + Vector3d(0.12, 0.09, 0.015),
                  palette.dark_plastic, 0.3);
  builder.add_box(foot + Vector3d(-0.03, 0.02, 0.015), foot + Vector3d(0.03, 0.06, 0.16),
                  palette.dark_plastic, 0.3);
  const Vector3d low = foot + Vector3d(-kHalfWidth, -kThickness, 0.12);
  builder.add_box(low, low + Vector3d(2.0 * kHalfWidth, kThickness, kHeight), palette.dark_plastic, 0.3);
  constexpr double kFrame = 0.018;
  builder.add_textured_quad({low + Vector3d(kFrame, -0.002, kHeight - kFrame),
                             {2.0 * (kHalfWidth - kFrame), 0.0, 0.0},
                             {0.0, 0.0, -(kHeight - 2.0 * kFrame)}},
                            pick_random(palette.screens, random));
  builder.mark_last_emissive();
  // A label adds texture to the back of the monitor.
  builder.add_textured_quad(
      {low + Vector3d(kHalfWidth + 0.06, kThickness + 0.002, 0.24), {-0.12, 0.0, 0.0}, {0.0, 0.0, -0.12}},
      pick_random(palette.papers, random));
}

void add_book_pile(const SceneContext& context, const Vector3d& foot) {
  const auto& [builder, palette, random] = context;
  double z = 0.0;
  const int books = 2 + random.index(4);
  for (int i = 0; i < books; ++i) {
    const double thickness = random.uniform(0.02, 0.05), half = random.uniform(0.09, 0.12);
    const double shift = random.uniform(-0.015, 0.015);
    const Vector3d low = foot + Vector3d(shift - half, -0.08, z);
    const TextureRegion spine{random.index(kSpinesPerTexture) / 16.0, 0.0, 1.0 / kSpinesPerTexture, 1.0};
    const int cover = pick_random(palette.plain_colors, random), back = pick_random(palette.spines, random);
    builder.add_labeled_box(low, low + Vector3d(2.0 * half, 0.16, thickness), {spine, back}, cover);
    z += thickness;
  }
}

void add_desk_clutter(const SceneContext& context) {
  const auto& [builder, palette, random] = context;
  const double z = kDeskHeight + 0.003;
  lay_flat(builder, {random.uniform(-0.1, 0.1), {random.uniform(-0.15, 0.1), -0.55, z + 0.012}, 0.44, 0.15},
           palette.keyboards.front());
  for (int i = 0; i < 4; ++i) {
    const double y = random.uniform(-0.68, -0.25), x = random.uniform(-0.65, 0.65);
    const int paper = pick_random(palette.papers, random);
    lay_flat(builder, {random.uniform(-0.6, 0.6), {x, y, z + 0.001 * i}, 0.21, 0.297}, paper);
  }
  add_book_pile(context, {random.chance(0.5) ? -0.62 : 0.62, random.uniform(-0.4, -0.2), kDeskHeight});
  const int cup = pick_random(palette.plain_colors, random);
  builder.add_cylinder({{random.uniform(0.3, 0.5), random.uniform(-0.6, -0.45), kDeskHeight}, 0.04, 0.1}, cup,
                       0.1);
  const double box_y = random.uniform(-0.62, -0.5), box_x = random.uniform(-0.6, -0.45);
  const Vector3d box(box_x, box_y, kDeskHeight);
  const int side = pick_random(palette.plain_colors, random);
  const TextureRegion front{0.25 * random.index(4), 0.25 * random.index(4), 0.25, 0.25};
  builder.add_labeled_box(box, box + Vector3d(0.14, 0.09, 0.2),
                          {front, pick_random(palette.packages, random)}, side);
}

/// One row of books from x = 0 to `width`.
void add_book_row(const SceneContext& context, const Vector3d& start, double width) {
  const auto& [builder, palette, random] = context;
  double x = 0.0;
  while (x < width - 0.08) {
    const double thickness = random.uniform(0.025, 0.06), height = random.uniform(0.2, 0.29);
    if (random.chance(0.12)) {  // a gap
      x += random.uniform(0.05, 0.2);
      continue;
    }
    const Vector3d low = start + Vector3d(x, random.uniform(0.0, 0.05), 0.0);
    const TextureRegion spine{random.index(kSpinesPerTexture) / 16.0, 0.0, 1.0 / kSpinesPerTexture, 1.0};
    const int cover = pick_random(palette.plain_colors, random), back = pick_random(palette.spines, random);
    builder.add_labeled_box(low, low + Vector3d(thickness, 0.2, height), {spine, back}, cover);
    x += thickness + 0.001;
  }
}

/// One row of packages from x = 0 to `width`; each article is repeated one to three times.
void add_goods_row(const SceneContext& context, const Vector3d& start, double width, double height) {
  const auto& [builder, palette, random] = context;
  double x = 0.02;
  while (x < width - 0.3) {
    const double w = random.uniform(0.1, 0.24), h = random.uniform(0.6, 0.95) * height;
    const int front = pick_random(palette.packages, random), side = pick_random(palette.plain_colors, random);
    const TextureRegion region{0.25 * random.index(4), 0.25 * random.index(4), 0.25, 0.25};
    const int facings = 1 + random.index(3);
    for (int i = 0; i < facings && x < width - w; ++i, x += w + 0.012) {
      const Vector3d low = start + Vector3d(x, random.uniform(0.0, 0.06), 0.0);
      builder.add_labeled_box(low, low + Vector3d(w, 0.3, h), {region, front}, side);
    }
    x += random.uniform(0.0, 0.05);
  }
}

}  // namespace

void add_desk(const SceneContext& context, const Placement& placement) {
  const auto& [builder, palette, random] = context;
  builder.set_frame(placement.position, placement.yaw);  // the desk top spans y = -0.8 to 0
  builder.add_box({-0.8, -0.8, kDeskHeight - 0.03}, {0.8, 0.0, kDeskHeight}, palette.oak, 1.2);
  for (const double x : {-0.76, 0.71}) {
    for (const double y : {-0.76, -0.09}) {
      builder.add_box({x, y, 0.0}, {x + 0.05, y + 0.05, kDeskHeight - 0.03}, palette.metal, 0.5);
    }
  }
  builder.add_box({0.3, -0.7, 0.08}, {0.68, -0.12, 0.62}, palette.light_plastic, 0.6);
  builder.add_labeled_box({-0.7, -0.6, 0.02}, {-0.5, -0.15, 0.45}, {{}, pick_random(palette.papers, random)},
                          palette.dark_plastic);
  add_monitor(context, {random.uniform(-0.1, 0.25), -0.22, kDeskHeight});
  add_desk_clutter(context);
}

void add_chair(const SceneContext& context, const Placement& placement) {
  const auto& [builder, palette, random] = context;
  builder.set_frame(placement.position, placement.yaw);  // front towards -y
  const int fabric = pick_random(palette.fabrics, random);
  builder.add_box({-0.24, -0.24, 0.42}, {0.24, 0.24, 0.49}, fabric, 0.4);
  builder.add_box({-0.22, 0.2, 0.55}, {0.22, 0.25, 1.0}, fabric, 0.4);
  builder.add_box({-0.03, 0.22, 0.42}, {0.03, 0.25, 0.6}, palette.dark_plastic, 0.3);
  builder.add_cylinder({{0.0, 0.0, 0.08}, 0.03, 0.34, 8}, palette.metal, 0.2);
  builder.add_box({-0.28, -0.03, 0.05}, {0.28, 0.03, 0.09}, palette.dark_plastic, 0.3);
  builder.add_box({-0.03, -0.28, 0.045}, {0.03, 0.28, 0.085}, palette.dark_plastic, 0.3);
}

void add_bookshelf(const SceneContext& context, const Placement& placement, double width) {
  Builder& builder = context.builder;
  const Palette& palette = context.palette;
  builder.set_frame(placement.position,
                    placement.yaw);  // spans x = 0 to width; front at y = 0, back at y = 0.3
  constexpr double kDepth = 0.3, kPanel = 0.025, kShelfHeight = 0.36;
  constexpr int kShelves = 5;
  constexpr double kHeight = kShelves * kShelfHeight + kPanel;
  builder.add_box({-kPanel, 0.0, 0.0}, {0.0, kDepth, kHeight}, palette.walnut, 1.0);
  builder.add_box({width, 0.0, 0.0}, {width + kPanel, kDepth, kHeight}, palette.walnut, 1.0);
  builder.add_box({0.0, kDepth - 0.02, 0.0}, {width, kDepth, kHeight}, palette.walnut, 1.0);
  for (int shelf = 0; shelf <= kShelves; ++shelf) {
    const double z = shelf * kShelfHeight;
    builder.add_box({0.0, 0.0, z}, {width, kDepth - 0.02, z + kPanel}, palette.walnut, 1.0);
    if (shelf < kShelves) add_book_row(context, {0.0, 0.03, z + kPanel}, width);
  }
}

void add_market_shelf(const SceneContext& context, const Placement& placement, double length) {
  const auto& [builder, palette, random] = context;
  constexpr double kDepth = 0.45, kShelfHeight = 0.42;
  constexpr int kShelves = 4;
  const double height = kShelves * kShelfHeight + 0.15;
  for (const double turn : {0.0, std::numbers::pi}) {  // two halves, back to back
    builder.set_frame(placement.position, placement.yaw + turn);
    const double left = -0.5 * length;
    builder.add_box({left, -kDepth, 0.0}, {-left, 0.0, 0.12}, palette.metal, 0.8);
    builder.add_box({left, -0.02, 0.12}, {-left, 0.0, height}, palette.light_plastic, 0.8);
    for (int shelf = 0; shelf < kShelves; ++shelf) {
      const double z = 0.12 + shelf * kShelfHeight;
      builder.add_box({left, -kDepth, z}, {-left, -0.02, z + 0.03}, palette.metal, 0.8);
      for (double x = left + 0.05; x + 0.09 < -left; x += random.uniform(0.25, 0.6)) {  // price tags
        builder.add_textured_quad({{x, -kDepth - 0.003, z + 0.035}, {0.08, 0.0, 0.0}, {0.0, 0.0, -0.045}},
                                  pick_random(palette.papers, random));
      }
      add_goods_row(context, {left, -kDepth + 0.04, z + 0.03}, length, kShelfHeight - 0.05);
    }
  }
}

void add_carton_pile(const SceneContext& context, const Placement& placement) {
  const auto& [builder, palette, random] = context;
  double z = 0.0;
  const int cartons = 1 + random.index(3);
  for (int i = 0; i < cartons; ++i) {
    const double half = random.uniform(0.2, 0.3), height = random.uniform(0.25, 0.4);
    builder.set_frame(placement.position + Vector3d(0.0, 0.0, z), placement.yaw + random.uniform(-0.3, 0.3));
    for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
      builder.set_frame(placement.position + Vector3d(0.0, 0.0, z), placement.yaw + turn * std::numbers::pi);
      builder.add_textured_quad({{-half, -half, height}, {2.0 * half, 0.0, 0.0}, {0.0, 0.0, -height}},
                                palette.carton);
    }
    builder.add_textured_quad({{-half, half, height}, {2.0 * half, 0.0, 0.0}, {0.0, -2.0 * half, 0.0}},
                              palette.carton);
    z += height;
  }
}

void add_bin(Builder& builder, const Placement& placement, const Palette& palette) {
  builder.set_frame(placement.position, placement.yaw);
  builder.add_cylinder({Vector3d::Zero(), 0.17, 0.4, 16}, palette.dark_plastic, 0.3);
}

namespace {

using Eigen::Vector2d;

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
