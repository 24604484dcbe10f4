// SPDX-License-Identifier: BSD-3-Clause
/// Brushes for procedural textures: noise at several scales, print, simple drawings.
#pragma once

#include <opencv2/core.hpp>

#include "datasets/synthetic/counter_random.h"

namespace stillpoint {

/// Red, green, blue in 0..255 (square roots of reflectance, see Texture).
using Colour = cv::Scalar;

/// A pleasant random colour. @param brightness its largest channel @param saturation 0 = gray, 1 = pure
[[nodiscard]] Colour random_colour(RandomSequence& random, double brightness, double saturation);

[[nodiscard]] cv::Mat blank_canvas(int width, int height, const Colour& colour);

/// Adds tileable smooth noise of lattice constant (cell_x, cell_y) [px] and peak `amplitude` [grey levels].
void add_noise(cv::Mat& canvas, double amplitude, int cell_x, int cell_y, RandomSequence& random);

/// Adds noise at three scales: `cell`, a quarter and a sixteenth of it, each with half the amplitude of the
/// last.
void add_rough_noise(cv::Mat& canvas, double amplitude, int cell, RandomSequence& random);

/// Adds independent noise to every pixel, the same in its three channels.
void add_grain(cv::Mat& canvas, double amplitude, RandomSequence& random);

void fill_rect(cv::Mat& canvas, const cv::Rect& area, const Colour& colour);

/// One line of random words that fills the width of `area` at most; letters as tall as the area.
void draw_words(cv::Mat& canvas, const cv::Rect& area, const Colour& ink, RandomSequence& random);

/// Lines of small print: ragged right, with paragraphs. @param line_px from line to line
void draw_print(cv::Mat& canvas, const cv::Rect& area, int line_px, const Colour& ink,
                RandomSequence& random);

/// A picture of a kind: sky and ground, discs, triangles, bars.
void draw_picture(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random);

/// A bar code.
void draw_barcode(cv::Mat& canvas, const cv::Rect& area, RandomSequence& random);

}  // namespace stillpoint
