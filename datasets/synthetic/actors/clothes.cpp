// SPDX-License-Identifier: BSD-3-Clause
#include <opencv2/imgproc.hpp>

#include "datasets/synthetic/materials/surfaces.h"

namespace stillpoint::synth {
namespace {

constexpr int kSide = 512;

struct Stripes {
  int period = 64;
  int width = 10;
  bool upright = false;
};

void add_stripes(cv::Mat& canvas, const Color& color, const Stripes& stripes) {
  const auto& [period, width, upright] = stripes;
  for (int at = 0; at + width <= kSide; at += period) {
    fill_rect(canvas, upright ? cv::Rect(at, 0, width, kSide) : cv::Rect(0, at, kSide, width), color);
  }
}

}  // namespace

cv::Mat paint_clothes(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kSide, kSide, random_color(random, random.uniform(90.0, 220.0), 0.55));
  const Color second = random_color(random, random.uniform(60.0, 230.0), 0.6);
  const int kind = random.index(4);
  if (kind == 0 || kind == 1) add_stripes(canvas, second, {64, 18 + random.index(20), false});
  if (kind == 1) add_stripes(canvas, random_color(random, 150.0, 0.5), {64, 10, true});
  if (kind == 2) {
    draw_words(canvas, {20, 150, 300, 70}, second, random);
    draw_illustration(canvas, {60, 240, 150, 120}, random);
    draw_words(canvas, {270, 330, 230, 60}, second, random);
  }
  if (kind == 3) {
    for (int i = 0; i < 90; ++i) {
      const int y = random.index(kSide), x = random.index(kSide);
      cv::circle(canvas, {x, y}, 6 + random.index(14), i % 2 == 0 ? second : Color(230, 230, 225), cv::FILLED,
                 cv::LINE_AA);
    }
  }
  add_rough_noise(canvas, 12.0, 64, random);  // folds
  add_grain(canvas, 4.0, random);
  return canvas;
}

}  // namespace stillpoint::synth
