// SPDX-License-Identifier: BSD-3-Clause
/// Pictures like real ones, for benchmarks of the front end.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace stillpoint {

/// The size of the paper's OpenLORIS pictures.
inline const cv::Size kPictureSize(848, 480);

/// Overlapping rectangles of all sizes ("dead leaves": edges, flat areas and corners in the proportions of
/// real pictures; Lee, Mumford and Huang 2001) under sensor noise, seen `shift_px` further to the right.
inline cv::Mat leaves_picture(int shift_px = 0) {
  constexpr int kMaxShiftPx = 64;
  constexpr int kLeaves = 3000;
  cv::Mat leaves(kPictureSize.height, kPictureSize.width + kMaxShiftPx, CV_8UC1, cv::Scalar(128));
  cv::RNG random(1);
  for (int i = 0; i < kLeaves; ++i) {
    const double side_px = 6.0 / (0.03 + random.uniform(0.0, 1.0));  // 6 to 200
    const cv::Point corner(random.uniform(-100, leaves.cols), random.uniform(-100, leaves.rows));
    const cv::Size size(cvRound(side_px), cvRound(side_px * random.uniform(0.5, 2.0)));
    cv::rectangle(leaves, cv::Rect(corner, size), random.uniform(20, 236), cv::FILLED);
  }
  cv::GaussianBlur(leaves, leaves, cv::Size(), 1.0);
  cv::Mat picture = leaves(cv::Rect({shift_px, 0}, kPictureSize)).clone();
  cv::Mat noise(picture.size(), CV_8SC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::add(picture, noise, picture, cv::noArray(), CV_8UC1);
  return picture;
}

}  // namespace stillpoint
