// SPDX-License-Identifier: BSD-3-Clause
/// Synthetic images with natural image statistics, for benchmarks of the front end.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace stillpoint {

/// Image size of OpenLORIS, as used in the paper.
inline const cv::Size kImageSize(848, 480);

/// "Dead leaves" image (overlapping rectangles with a power-law size distribution, which reproduces the
/// statistics of edges, flat areas and corners in natural images; Lee, Mumford and Huang 2001) with sensor
/// noise. `shift_px` moves the view to the right.
inline cv::Mat dead_leaves_image(int shift_px = 0) {
  constexpr int kMaxShiftPx = 64;
  constexpr int kLeaves = 3000;
  cv::Mat leaves(kImageSize.height, kImageSize.width + kMaxShiftPx, CV_8UC1, cv::Scalar(128));
  cv::RNG random(1);
  for (int i = 0; i < kLeaves; ++i) {
    const double side_px = 6.0 / (0.03 + random.uniform(0.0, 1.0));  // 6 to 200
    const int y = random.uniform(-100, leaves.rows), x = random.uniform(-100, leaves.cols);
    const cv::Size size(cvRound(side_px), cvRound(side_px * random.uniform(0.5, 2.0)));
    cv::rectangle(leaves, cv::Rect({x, y}, size), random.uniform(20, 236), cv::FILLED);
  }
  cv::GaussianBlur(leaves, leaves, cv::Size(), 1.0);
  cv::Mat image = leaves(cv::Rect({shift_px, 0}, kImageSize)).clone();
  cv::Mat noise(image.size(), CV_8SC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  cv::add(image, noise, image, cv::noArray(), CV_8UC1);
  return image;
}

}  // namespace stillpoint
