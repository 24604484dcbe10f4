// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/materials/surfaces.h"
#include "datasets/synthetic/scenes/furniture.h"

namespace stillpoint::synth {
namespace {

template <class Paint>
std::vector<int> add_textures(Builder& builder, int count, const Paint& paint, RandomSequence& random) {
  std::vector<int> numbers;
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

}  // namespace stillpoint::synth
