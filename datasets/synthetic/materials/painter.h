// SPDX-License-Identifier: BSD-3-Clause
/// Drawing primitives of procedural textures: multi-scale noise, text, simple illustrations.
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

}  // namespace stillpoint::synth
