// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/furniture.h"
#include "datasets/synthetic/surfaces.h"

namespace stillpoint {
namespace {

template <class Paint>
std::vector<int> several(Builder& builder, int count, const Paint& paint, RandomSequence& random) {
  std::vector<int> numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(builder.add_texture(paint(random)));
  return numbers;
}

}  // namespace

Palette make_palette(Builder& builder, std::uint64_t seed) {
  RandomSequence random(random_key(seed, RandomStream::kTexture));
  const auto one = [&builder](const cv::Mat& picture) { return builder.add_texture(picture); };
  Palette palette;
  palette.carpet = one(paint_carpet(Colour(128, 132, 142), random));
  palette.tiles = one(paint_tiles(Colour(185, 178, 165), 4, random));
  palette.plaster = one(paint_plaster(Colour(205, 203, 196), random));
  palette.ceiling = one(paint_ceiling(random));
  palette.lamp = one(blank_canvas(4, 4, Colour(255, 255, 250)));
  palette.oak = one(paint_wood(Colour(190, 155, 112), random));
  palette.walnut = one(paint_wood(Colour(120, 88, 62), random));
  palette.metal = one(paint_plain(Colour(165, 168, 172), 8.0, random));
  palette.dark_plastic = one(paint_plain(Colour(58, 58, 62), 8.0, random));
  palette.light_plastic = one(paint_plain(Colour(205, 203, 195), 6.0, random));
  palette.paint = one(paint_plaster(Colour(170, 180, 185), random));
  palette.carton = one(paint_carton(random));
  palette.door = one(paint_door(Colour(150, 112, 78), random));
  palette.window = one(paint_window(random));
  const auto fabric = [](RandomSequence& r) { return paint_fabric(random_colour(r, 140.0, 0.6), r); };
  const auto plain = [](RandomSequence& r) { return paint_plain(random_colour(r, 200.0, 0.7), 10.0, r); };
  palette.fabrics = several(builder, 4, fabric, random);
  palette.posters = several(builder, 10, paint_poster, random);
  palette.boards = several(builder, 2, paint_noticeboard, random);
  palette.papers = several(builder, 6, paint_paper, random);
  palette.screens = several(builder, 4, paint_screen, random);
  palette.keyboards = several(builder, 1, paint_keyboard, random);
  palette.spines = several(builder, 3, paint_book_spines, random);
  palette.packages = several(builder, 3, paint_packages, random);
  palette.plains = several(builder, 6, plain, random);
  return palette;
}

int any_of(const std::vector<int>& textures, RandomSequence& random) {
  return textures[static_cast<std::size_t>(random.index(static_cast<int>(textures.size())))];
}

}  // namespace stillpoint
