// SPDX-License-Identifier: BSD-3-Clause
/// Procedural textures of the synthetic world, and the primitives that draw them: multi-scale noise, text,
/// simple illustrations. All textures are CV_8UC3 with power-of-two sides.
#pragma once

#include <opencv2/core.hpp>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint::synth {

/// Red, green, blue in 0..255 (square root of reflectance, see Texture).
using Color = cv::Scalar;

/// Color of random hue. @param brightness largest channel @param saturation 0 = gray, 1 = pure hue
[[nodiscard]] Color random_color(RandomSequence& random, double brightness, double saturation);

[[nodiscard]] cv::Mat blank_canvas(int width, int height, const Color& color);

/// Adds tileable smooth noise of lattice constant `cell` [px] and peak `amplitude` [grey levels].
void add_noise(cv::Mat& canvas, double amplitude, const cv::Size& cell, RandomSequence& random);

/// Adds noise at three scales, `cell`, `cell` / 4 and `cell` / 16; the amplitude halves with each scale.
void add_rough_noise(cv::Mat& canvas, double amplitude, int cell, RandomSequence& random);

/// Adds white noise per pixel, equal in all three channels.
void add_grain(cv::Mat& canvas, double amplitude, RandomSequence& random);

void fill_rect(cv::Mat& canvas, const cv::Rect& area, const Color& color);

/// One line of random words, at most as wide as `area`; the letters fill its height.
void draw_words(cv::Mat& canvas, const cv::Rect& area, const Color& ink, RandomSequence& random);

/// Small text.
struct PrintStyle {
  int line_px = 10;  ///< line spacing
  Color ink;
};

/// Lines of small text: ragged right, with paragraphs.
void draw_print(cv::Mat& canvas, const cv::Rect& area, const PrintStyle& style, RandomSequence& random);

/// An abstract illustration: sky and ground, disks, triangles, bars.
void draw_illustration(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random);

/// A bar code.
void draw_barcode(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random);

// Seamlessly tileable textures.
[[nodiscard]] cv::Mat paint_plain(const Color& base, double roughness, RandomSequence& random);
[[nodiscard]] cv::Mat paint_carpet(const Color& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_wood(const Color& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_fabric(const Color& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_plaster(const Color& base, RandomSequence& random);
/// @param count tiles along each side of the texture
[[nodiscard]] cv::Mat paint_tiles(const Color& base, int count, RandomSequence& random);
[[nodiscard]] cv::Mat paint_ceiling(RandomSequence& random);

// Oriented textures, not tileable: v grows downwards.
[[nodiscard]] cv::Mat paint_poster(RandomSequence& random);
[[nodiscard]] cv::Mat paint_noticeboard(RandomSequence& random);
[[nodiscard]] cv::Mat paint_paper(RandomSequence& random);
[[nodiscard]] cv::Mat paint_screen(RandomSequence& random);
[[nodiscard]] cv::Mat paint_keyboard(RandomSequence& random);
[[nodiscard]] cv::Mat paint_door(const Color& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_window(RandomSequence& random);
[[nodiscard]] cv::Mat paint_carton(RandomSequence& random);

/// Shirt fabric: stripes, checks, print or dots.
[[nodiscard]] cv::Mat paint_clothes(RandomSequence& random);

/// Sixteen book spines side by side.
[[nodiscard]] cv::Mat paint_book_spines(RandomSequence& random);
/// Four by four fronts of packaged goods.
[[nodiscard]] cv::Mat paint_packages(RandomSequence& random);
inline constexpr int kSpinesPerTexture = 16;
inline constexpr int kPackagesPerSide = 4;

}  // namespace stillpoint::synth
