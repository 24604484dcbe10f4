// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/materials/surfaces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace stillpoint::synth {
namespace {

std::string random_word(RandomSequence& random) {
  constexpr std::string_view kLetters = "eeeaaiioutnrslcdmphgbfywkvxz";
  std::string word;
  const int length = 2 + random.index(8);
  for (int i = 0; i < length; ++i) {
    word += kLetters[static_cast<std::size_t>(random.index(static_cast<int>(kLetters.size())))];
  }
  if (random.chance(0.3)) word[0] = static_cast<char>(word[0] - 'a' + 'A');
  return word;
}

void add_to_pixel(cv::Vec3b& pixel, double change) {
  for (int channel = 0; channel < 3; ++channel)
    pixel[channel] = cv::saturate_cast<std::uint8_t>(pixel[channel] + change);
}

double smooth_step(double x) { return x * x * (3.0 - 2.0 * x); }

cv::Point random_point(const cv::Rect& area, RandomSequence& random) {
  return {area.x + random.index(area.width), area.y + random.index(area.height)};
}

}  // namespace

Color random_color(RandomSequence& random, double brightness, double saturation) {
  const double hue = random.uniform(0.0, 6.0);
  const auto channel = [&](double shift) {
    const double wheel = std::abs(std::fmod(hue + shift, 6.0) - 3.0) - 1.0;
    return brightness * (1.0 - saturation + saturation * std::clamp(wheel, 0.0, 1.0));
  };
  return {channel(0.0), channel(2.0), channel(4.0)};
}

cv::Mat blank_canvas(int width, int height, const Color& color) { return {height, width, CV_8UC3, color}; }

void add_noise(cv::Mat& canvas, double amplitude, const cv::Size& cell, RandomSequence& random) {
  const int columns = std::max(1, canvas.cols / cell.width), rows = std::max(1, canvas.rows / cell.height);
  std::vector<double> lattice(static_cast<std::size_t>(columns * rows));
  for (double& node : lattice) node = random.uniform(-amplitude, amplitude);
  /// Nodes on both sides of a pixel, and the weight of the second.
  struct Between {
    int first, second;
    double weight;
  };
  const auto between = [](int pixel, int cell_px, int nodes) {
    const double fraction = static_cast<double>(pixel % cell_px) / cell_px;
    return Between{(pixel / cell_px) % nodes, (pixel / cell_px + 1) % nodes, smooth_step(fraction)};
  };
  std::vector<Between> across;
  across.reserve(static_cast<std::size_t>(canvas.cols));
  for (int x = 0; x < canvas.cols; ++x) across.push_back(between(x, cell.width, columns));
  for (int y = 0; y < canvas.rows; ++y) {
    const Between down = between(y, cell.height, rows);
    const double* const upper = lattice.data() + std::ptrdiff_t{down.first} * columns;
    const double* const lower = lattice.data() + std::ptrdiff_t{down.second} * columns;
    auto* const pixels = canvas.ptr<cv::Vec3b>(y);
    for (int x = 0; x < canvas.cols; ++x) {
      const auto& [left, right, weight] = across[static_cast<std::size_t>(x)];
      const double top = std::lerp(upper[left], upper[right], weight);
      const double bottom = std::lerp(lower[left], lower[right], weight);
      add_to_pixel(pixels[x], std::lerp(top, bottom, down.weight));
    }
  }
}

void add_rough_noise(cv::Mat& canvas, double amplitude, int cell, RandomSequence& random) {
  for (int size = cell; size >= std::max(2, cell / 16); size /= 4, amplitude *= 0.5) {
    add_noise(canvas, amplitude, {size, size}, random);
  }
}

void add_grain(cv::Mat& canvas, double amplitude, RandomSequence& random) {
  for (int y = 0; y < canvas.rows; ++y) {
    for (int x = 0; x < canvas.cols; ++x) {
      add_to_pixel(canvas.at<cv::Vec3b>(y, x),
                   amplitude * static_cast<double>(normal_from_bits(random.bits())));
    }
  }
}

void fill_rect(cv::Mat& canvas, const cv::Rect& area, const Color& color) {
  cv::rectangle(canvas, area, color, cv::FILLED);
}

void draw_words(cv::Mat& canvas, const cv::Rect& area, const Color& ink, RandomSequence& random) {
  const double scale = area.height / 30.0;  // Hershey letters are about 22 px tall at scale 1, tails 8
  const int weight = std::max(1, static_cast<int>(std::lround(scale * 2.0)));
  const auto font = scale < 0.35 ? cv::FONT_HERSHEY_PLAIN : cv::FONT_HERSHEY_DUPLEX;
  const double font_scale = font == cv::FONT_HERSHEY_PLAIN ? 2.0 * scale : scale;
  std::string text = random_word(random);
  while (text.size() < 80) {
    const std::string longer = text + " " + random_word(random);
    if (cv::getTextSize(longer, font, font_scale, weight, nullptr).width > area.width) break;
    text = longer;
  }
  cv::putText(canvas, text, {area.x, area.y + area.height * 3 / 4}, font, font_scale, ink, weight,
              cv::LINE_AA);
}

void draw_print(cv::Mat& canvas, const cv::Rect& area, const PrintStyle& style, RandomSequence& random) {
  const auto& [line_px, ink] = style;
  for (int y = area.y; y + line_px <= area.y + area.height; y += line_px) {
    if (random.chance(0.12)) continue;  // a blank line between paragraphs
    const int width = static_cast<int>(area.width * (random.chance(0.2) ? random.uniform(0.3, 0.8) : 1.0));
    draw_words(canvas, {area.x, y, width, line_px * 9 / 10}, ink, random);
  }
}

void draw_illustration(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random) {
  cv::Mat part = canvas(area);
  const cv::Rect inside(0, 0, area.width, area.height);
  part.setTo(random_color(random, 220.0, 0.35));
  fill_rect(part, {0, area.height * 2 / 3, area.width, area.height / 3}, random_color(random, 120.0, 0.5));
  const int shapes = 5 + random.index(6);
  for (int i = 0; i < shapes; ++i) {
    const Color color = random_color(random, random.uniform(60.0, 240.0), 0.6);
    const int size = std::max(2, static_cast<int>(random.uniform(0.06, 0.3) * area.width));
    const cv::Point at = random_point(inside, random);
    if (random.chance(0.35)) {
      cv::circle(part, at, size / 2, color, cv::FILLED, cv::LINE_AA);
    } else if (random.chance(0.5)) {
      cv::rectangle(part, at, at + cv::Point(size, size * 2 / 3), color, cv::FILLED);
    } else {
      const std::vector<cv::Point> triangle{at, at + cv::Point(size, size / 3),
                                            at + cv::Point(size / 4, size)};
      cv::fillConvexPoly(part, triangle, color, cv::LINE_AA);
    }
  }
  add_noise(part, 12.0, {std::max(2, area.width / 16), std::max(2, area.width / 16)}, random);
}

void draw_barcode(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random) {
  fill_rect(canvas, area, Color(240, 240, 240));
  for (int x = area.x + 2; x < area.x + area.width - 3;) {
    const int width = 1 + random.index(3);
    fill_rect(canvas, {x, area.y + 2, width, area.height - 4}, Color(20, 20, 20));
    x += width + 1 + random.index(3);
  }
}

namespace {

constexpr int kTiledSide = 1024;  // sides of tileable textures [px]
constexpr int kObjectSide = 512;  // sides of most oriented textures [px]

Color darker(const Color& color, double factor) {
  return {color[0] * factor, color[1] * factor, color[2] * factor};
}

struct Specks {
  int count = 0;
  int largest_px = 1;
  double contrast = 0.0;  ///< [gray levels]
};

/// Random specks (knots, stains, fibers) that add corners to surfaces with little texture.
void add_specks(cv::Mat& canvas, const Specks& specks, RandomSequence& random) {
  const auto& [count, largest_px, contrast] = specks;
  for (int i = 0; i < count; ++i) {
    const int y = random.index(canvas.rows), x = random.index(canvas.cols);
    const cv::Point at(x, y);
    const double change = random.uniform(-contrast, contrast);
    const cv::Vec3b under = canvas.at<cv::Vec3b>(at);
    const Color color(under[0] + change, under[1] + change, under[2] + change);
    const int minor_px = 1 + random.index(std::max(1, largest_px / 2));
    const int major_px = 1 + random.index(largest_px);
    cv::ellipse(canvas, at, {major_px, minor_px}, random.uniform(0.0, 180.0), 0.0, 360.0, color, cv::FILLED,
                cv::LINE_AA);
  }
}

void draw_sheet(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random) {
  fill_rect(canvas, area, random.chance(0.7) ? Color(235, 235, 228) : random_color(random, 235.0, 0.35));
  const int margin = std::max(3, area.width / 12);
  const cv::Rect inner(area.x + margin, area.y + margin, area.width - 2 * margin, area.height - 2 * margin);
  const int title_px = std::max(10, inner.height / 9);
  const Color ink = random.chance(0.6) ? Color(30, 30, 35) : random_color(random, 130.0, 0.8);
  draw_words(canvas, {inner.x, inner.y, inner.width, title_px}, ink, random);
  const int illustration_px = random.chance(0.5) ? inner.height / 3 : 0;
  if (illustration_px > 0)
    draw_illustration(canvas, {inner.x, inner.y + title_px + 4, inner.width, illustration_px - 4}, random);
  const int top = inner.y + title_px + illustration_px + 4;
  draw_print(canvas, {inner.x, top, inner.width, inner.y + inner.height - top}, {9, Color(50, 50, 55)},
             random);
}

void draw_spine(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random) {
  const double saturation = random.uniform(0.1, 0.8), brightness = random.uniform(60.0, 220.0);
  const Color cover = random_color(random, brightness, saturation);
  fill_rect(canvas, area, cover);
  const bool dark = cover[0] + cover[1] + cover[2] < 330.0;
  const Color ink = dark ? Color(235, 230, 215) : Color(25, 25, 30);
  cv::Mat lying = blank_canvas(area.height, area.width, cover);  // drawn horizontally, then rotated
  draw_words(lying, {area.height / 8, area.width / 5, area.height * 5 / 8, area.width * 3 / 5}, ink, random);
  cv::Mat upright;
  cv::rotate(lying, upright, cv::ROTATE_90_CLOCKWISE);
  upright.copyTo(canvas(area));
  for (int band = 0; band < 2; ++band) {
    const int y = area.y + static_cast<int>(random.uniform(0.02, 0.98) * (area.height - 14));
    const Color color = random_color(random, 210.0, 0.6);
    fill_rect(canvas, {area.x, y, area.width, 4 + random.index(10)}, color);
  }
  cv::line(canvas, area.tl(), {area.x, area.y + area.height}, darker(cover, 0.4), 2);
}

void draw_package(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random) {
  const double saturation = random.uniform(0.3, 0.9), brightness = random.uniform(120.0, 235.0);
  fill_rect(canvas, area, random_color(random, brightness, saturation));
  const int pad = area.width / 10;
  fill_rect(canvas, {area.x, area.y + pad, area.width, area.height / 4}, random_color(random, 230.0, 0.5));
  draw_words(canvas, {area.x + pad, area.y + pad + 2, area.width - pad, area.height / 4 - 4},
             random_color(random, 90.0, 0.9), random);
  draw_illustration(canvas,
                    {area.x + pad, area.y + area.height * 4 / 10, area.width - 2 * pad, area.height * 3 / 10},
                    random);
  draw_print(canvas, {area.x + pad, area.y + area.height * 3 / 4, area.width / 2, area.height / 5},
             {8, Color(25, 25, 25)}, random);
  draw_barcode(canvas,
               {area.x + area.width * 2 / 3, area.y + area.height * 3 / 4, area.width / 4, area.height / 6},
               random);
  cv::rectangle(canvas, area, Color(30, 30, 30), 1);
}

void draw_window_frame(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random) {
  const bool dark = random.chance(0.4);
  fill_rect(canvas, area, dark ? Color(30, 32, 40) : Color(225, 225, 225));
  fill_rect(canvas, {area.x, area.y, area.width, 14}, random_color(random, 150.0, 0.6));
  const Color ink = dark ? Color(190, 210, 190) : Color(40, 40, 50);
  const cv::Rect text(area.x + 6, area.y + 20, area.width - 12, area.height - 26);
  if (random.chance(0.3)) {
    draw_illustration(canvas, text, random);
  } else {
    draw_print(canvas, text, {10, ink}, random);
  }
}

}  // namespace

cv::Mat paint_plain(const Color& base, double roughness, RandomSequence& random) {
  cv::Mat canvas = blank_canvas(256, 256, base);
  add_rough_noise(canvas, roughness, 64, random);
  add_grain(canvas, 0.5 * roughness, random);
  return canvas;
}

cv::Mat paint_carpet(const Color& base, RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kTiledSide, kTiledSide, base);
  add_rough_noise(canvas, 22.0, 128, random);
  add_grain(canvas, 12.0, random);
  add_specks(canvas, {2500, 5, 45.0}, random);
  for (int line = 0; line < kTiledSide; line += kTiledSide / 4) {  // seams of the carpet tiles
    fill_rect(canvas, {line, 0, 3, kTiledSide}, darker(base, 0.75));
    fill_rect(canvas, {0, line, kTiledSide, 3}, darker(base, 0.75));
  }
  return canvas;
}

cv::Mat paint_wood(const Color& base, RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kTiledSide, kTiledSide, base);
  add_noise(canvas, 14.0, {256, 64}, random);
  add_noise(canvas, 18.0, {256, 16}, random);
  add_noise(canvas, 16.0, {128, 4}, random);
  add_noise(canvas, 10.0, {64, 2}, random);
  add_specks(canvas, {120, 9, 50.0}, random);
  return canvas;
}

cv::Mat paint_fabric(const Color& base, RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kObjectSide, kObjectSide, base);
  add_rough_noise(canvas, 14.0, 64, random);
  add_noise(canvas, 12.0, {4, 16}, random);
  add_noise(canvas, 12.0, {16, 4}, random);
  return canvas;
}

cv::Mat paint_plaster(const Color& base, RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kTiledSide, kTiledSide, base);
  add_rough_noise(canvas, 7.0, 256, random);
  add_noise(canvas, 5.0, {8, 8}, random);
  add_grain(canvas, 2.5, random);
  add_specks(canvas, {420, 8, 38.0}, random);
  return canvas;
}

cv::Mat paint_tiles(const Color& base, int count, RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kTiledSide, kTiledSide, base);
  const int side = kTiledSide / count;
  for (int row = 0; row < count; ++row) {
    for (int column = 0; column < count; ++column) {
      const Color tile = darker(base, random.uniform(0.86, 1.08));
      fill_rect(canvas, {column * side + 3, row * side + 3, side - 6, side - 6}, tile);
    }
  }
  add_rough_noise(canvas, 10.0, 64, random);
  add_grain(canvas, 5.0, random);
  add_specks(canvas, {1600, 5, 40.0}, random);
  return canvas;
}

cv::Mat paint_ceiling(RandomSequence& random) {
  const Color base(205, 205, 200);
  cv::Mat canvas = blank_canvas(kObjectSide, kObjectSide, base);
  add_rough_noise(canvas, 6.0, 128, random);
  add_specks(canvas, {900, 3, 60.0}, random);
  fill_rect(canvas, {0, 0, 8, kObjectSide}, Color(165, 165, 165));
  fill_rect(canvas, {0, 0, kObjectSide, 8}, Color(165, 165, 165));
  return canvas;
}

cv::Mat paint_poster(RandomSequence& random) {
  cv::Mat canvas =
      blank_canvas(kObjectSide, kObjectSide, random_color(random, random.uniform(90.0, 240.0), 0.5));
  const Color ink = random.chance(0.5) ? Color(245, 245, 240) : Color(20, 20, 30);
  draw_words(canvas, {24, 18, 464, 64}, ink, random);
  draw_words(canvas, {24, 84, 300, 26}, ink, random);
  draw_illustration(canvas, {24, 124, 288, 210}, random);
  fill_rect(canvas, {326, 124, 162, 210}, Color(235, 235, 230));
  draw_print(canvas, {332, 130, 150, 200}, {12, Color(30, 30, 40)}, random);
  fill_rect(canvas, {24, 346, 464, 148}, Color(238, 238, 232));
  draw_print(canvas, {32, 352, 210, 138}, {11, Color(30, 30, 40)}, random);
  draw_illustration(canvas, {262, 356, 216, 128}, random);
  return canvas;
}

cv::Mat paint_noticeboard(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kTiledSide, kObjectSide, Color(150, 110, 72));
  add_grain(canvas, 14.0, random);
  for (int i = 0; i < 14; ++i) {
    const int width = 110 + random.index(60), height = 140 + random.index(60);
    const int y = 20 + random.index(kObjectSide - height - 40),
              x = 20 + random.index(kTiledSide - width - 40);
    const cv::Point at(x, y);
    draw_sheet(canvas, {at.x, at.y, width, height}, random);
    cv::circle(canvas, {at.x + width / 2, at.y + 6}, 6, random_color(random, 220.0, 0.9), cv::FILLED,
               cv::LINE_AA);
  }
  return canvas;
}

cv::Mat paint_paper(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(256, 256, Color(235, 235, 228));
  draw_sheet(canvas, {0, 0, 256, 256}, random);
  return canvas;
}

cv::Mat paint_screen(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kObjectSide, kObjectSide, random_color(random, 110.0, 0.6));
  add_noise(canvas, 20.0, {128, 128}, random);
  for (int i = 0; i < 3; ++i) {
    const int width = 200 + random.index(160), height = 180 + random.index(180);
    draw_window_frame(canvas,
                      {10 + random.index(kObjectSide - width - 20),
                       10 + random.index(kObjectSide - height - 40), width, height},
                      random);
  }
  fill_rect(canvas, {0, kObjectSide - 24, kObjectSide, 24}, Color(45, 50, 60));
  for (int x = 8; x < 220; x += 30)
    fill_rect(canvas, {x, kObjectSide - 20, 16, 16}, random_color(random, 230.0, 0.7));
  return canvas;
}

cv::Mat paint_keyboard(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kObjectSide, 256, Color(52, 52, 56));
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 18; ++column) {
      const cv::Rect key(12 + column * 27, 12 + row * 39, 23, 34);
      fill_rect(canvas, key, Color(32, 32, 34));
      cv::circle(canvas, key.tl() + cv::Point(8 + random.index(4), 11), 3, Color(200, 200, 200), 1,
                 cv::LINE_AA);
    }
  }
  return canvas;
}

cv::Mat paint_door(const Color& base, RandomSequence& random) {
  cv::Mat canvas = paint_wood(base, random);
  const int side = canvas.cols;
  cv::rectangle(canvas, {0, 0, side, side}, darker(base, 0.5), 40);
  fill_rect(canvas, {side * 5 / 8, side / 6, side / 5, side / 3}, Color(95, 110, 120));
  fill_rect(canvas, {side / 8, side / 2, side / 8, side / 40}, Color(185, 185, 190));
  fill_rect(canvas, {side / 8, side / 4, side / 4, side / 16}, Color(230, 230, 225));
  draw_words(canvas, {side / 8 + 8, side / 4 + 8, side / 4 - 16, side / 16 - 16}, Color(30, 30, 30), random);
  return canvas;
}

cv::Mat paint_window(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kObjectSide, kObjectSide, Color(215, 225, 240));
  draw_illustration(canvas, {0, kObjectSide / 3, kObjectSide, kObjectSide * 2 / 3}, random);
  add_noise(canvas, 18.0, {32, 32}, random);
  for (int line = 0; line <= kObjectSide; line += kObjectSide / 2) {
    fill_rect(canvas, {std::min(line, kObjectSide - 16) - (line > 0 ? 8 : 0), 0, 16, kObjectSide},
              Color(240, 240, 240));
  }
  fill_rect(canvas, {0, 0, kObjectSide, 16}, Color(240, 240, 240));
  fill_rect(canvas, {0, kObjectSide - 16, kObjectSide, 16}, Color(240, 240, 240));
  return canvas;
}

cv::Mat paint_carton(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kObjectSide, kObjectSide, Color(168, 128, 86));
  add_rough_noise(canvas, 10.0, 64, random);
  fill_rect(canvas, {kObjectSide / 2 - 24, 0, 48, kObjectSide}, Color(190, 160, 115));
  fill_rect(canvas, {40, 60, 170, 120}, Color(238, 238, 232));
  draw_print(canvas, {48, 66, 150, 70}, {14, Color(30, 30, 30)}, random);
  draw_barcode(canvas, {60, 140, 120, 34}, random);
  draw_words(canvas, {300, 330, 200, 60}, Color(70, 45, 30), random);
  return canvas;
}

cv::Mat paint_book_spines(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kTiledSide, kObjectSide, Color(0, 0, 0));
  constexpr int kWidth = kTiledSide / kSpinesPerTexture;
  for (int i = 0; i < kSpinesPerTexture; ++i)
    draw_spine(canvas, {i * kWidth, 0, kWidth, kObjectSide}, random);
  return canvas;
}

cv::Mat paint_packages(RandomSequence& random) {
  cv::Mat canvas = blank_canvas(kTiledSide, kTiledSide, Color(0, 0, 0));
  constexpr int kSide = kTiledSide / kPackagesPerSide;
  for (int i = 0; i < kPackagesPerSide * kPackagesPerSide; ++i) {
    draw_package(canvas, {i % kPackagesPerSide * kSide, i / kPackagesPerSide * kSide, kSide, kSide}, random);
  }
  return canvas;
}

namespace {

constexpr int kClothSide = 512;

struct Stripes {
  int period = 64;
  int width = 10;
  bool upright = false;
};

void add_stripes(cv::Mat& canvas, const Color& color, const Stripes& stripes) {
  const auto& [period, width, upright] = stripes;
  for (int at = 0; at + width <= kClothSide; at += period) {
    fill_rect(canvas, upright ? cv::Rect(at, 0, width, kClothSide) : cv::Rect(0, at, kClothSide, width),
              color);
  }
}

}  // namespace

cv::Mat paint_clothes(RandomSequence& random) {
  cv::Mat canvas =
      blank_canvas(kClothSide, kClothSide, random_color(random, random.uniform(90.0, 220.0), 0.55));
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
      const int y = random.index(kClothSide), x = random.index(kClothSide);
      cv::circle(canvas, {x, y}, 6 + random.index(14), i % 2 == 0 ? second : Color(230, 230, 225), cv::FILLED,
                 cv::LINE_AA);
    }
  }
  add_rough_noise(canvas, 12.0, 64, random);  // folds
  add_grain(canvas, 4.0, random);
  return canvas;
}

}  // namespace stillpoint::synth
