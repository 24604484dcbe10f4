// SPDX-License-Identifier: BSD-3-Clause
/// The steps of a pyramid of pictures with borders, in place: nothing is allocated, whoever owns the memory.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

/// Mirrors a picture into the memory around it, the pixel at the edge not repeated.
/// @param picture CV_8UC1, wider and higher than the border; part of a larger one with as much around it
void mirror_border(cv::Mat picture, int border_px);

/// Writes the picture at half the resolution, smoothed by 1 4 6 4 1 in both directions: the same pixels as
/// cv::pyrDown gives.
/// @param from CV_8UC1 with a mirrored border of 2 px or more
/// @param to   CV_8UC1 of half the size, rounded up
/// @param sums memory, as the last call left it
void halve(const cv::Mat& from, cv::Mat to, std::vector<std::uint16_t>& sums);

}  // namespace stillpoint
