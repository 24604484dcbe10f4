// SPDX-License-Identifier: BSD-3-Clause
/// Procedural textures of the synthetic world. All are CV_8UC3 with power-of-two sides.
#pragma once

#include "datasets/synthetic/materials/painter.h"

namespace stillpoint::synth {

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
