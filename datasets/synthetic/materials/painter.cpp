// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/synthetic/materials/painter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

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
  const auto node = [&](int row, int column) {
    return lattice[static_cast<std::size_t>((row % rows) * columns + column % columns)];
  };
  for (int y = 0; y < canvas.rows; ++y) {
    const int row = y / cell.height;
    const double weight_y = smooth_step(static_cast<double>(y % cell.height) / cell.height);
    for (int x = 0; x < canvas.cols; ++x) {
      const int column = x / cell.width;
      const double weight_x = smooth_step(static_cast<double>(x % cell.width) / cell.width);
      const double top = std::lerp(node(row, column), node(row, column + 1), weight_x);
      const double bottom = std::lerp(node(row + 1, column), node(row + 1, column + 1), weight_x);
      add_to_pixel(canvas.at<cv::Vec3b>(y, x), std::lerp(top, bottom, weight_y));
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

}  // namespace stillpoint::synth
