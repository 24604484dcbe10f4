// SPDX-License-Identifier: BSD-3-Clause
/// Border reflection and downsampling for image pyramids, on preallocated images.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

/// Fills the border around an image by reflection without repeating the edge pixel (cv::BORDER_REFLECT_101).
/// @param image CV_8UC1, wider and higher than the border; submatrix of an allocation with that border
void reflect_border(cv::Mat image, int border_px);

/// Smooths by the kernel (1 4 6 4 1) / 16 in both directions and halves the resolution; bit-identical to
/// cv::pyrDown.
/// @param from CV_8UC1 with a reflected border of at least 2 px
/// @param to   CV_8UC1 of half the size, rounded up
/// @param column_sums scratch buffer, reused between calls
void pyr_down(const cv::Mat& from, cv::Mat to, std::vector<std::uint16_t>& column_sums);

}  // namespace stillpoint
