// SPDX-License-Identifier: BSD-3-Clause
/// Paintings for the surfaces of the synthetic world. All return CV_8UC3 with sides that are powers of two.
#pragma once

#include "datasets/synthetic/painter.h"

namespace stillpoint {

// Endless surfaces: they tile without a seam.
[[nodiscard]] cv::Mat paint_plain(const Colour& base, double roughness, RandomSequence& random);
[[nodiscard]] cv::Mat paint_carpet(const Colour& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_wood(const Colour& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_fabric(const Colour& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_plaster(const Colour& base, RandomSequence& random);
/// @param count tiles along each side of the picture
[[nodiscard]] cv::Mat paint_tiles(const Colour& base, int count, RandomSequence& random);
[[nodiscard]] cv::Mat paint_ceiling(RandomSequence& random);

// Things with a left, right, top and bottom: v grows downwards.
[[nodiscard]] cv::Mat paint_poster(RandomSequence& random);
[[nodiscard]] cv::Mat paint_noticeboard(RandomSequence& random);
[[nodiscard]] cv::Mat paint_paper(RandomSequence& random);
[[nodiscard]] cv::Mat paint_screen(RandomSequence& random);
[[nodiscard]] cv::Mat paint_keyboard(RandomSequence& random);
[[nodiscard]] cv::Mat paint_door(const Colour& base, RandomSequence& random);
[[nodiscard]] cv::Mat paint_window(RandomSequence& random);
[[nodiscard]] cv::Mat paint_carton(RandomSequence& random);

/// Shirts: stripes, checks, print, dots.
[[nodiscard]] cv::Mat paint_clothes(RandomSequence& random);

/// Sixteen book spines side by side.
[[nodiscard]] cv::Mat paint_book_spines(RandomSequence& random);
/// Four by four fronts of packaged goods.
[[nodiscard]] cv::Mat paint_packages(RandomSequence& random);
inline constexpr int kSpinesPerPicture = 16;
inline constexpr int kPackagesPerSide = 4;

}  // namespace stillpoint
