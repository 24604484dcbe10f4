// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/feature_mask.h"

#include <cstdint>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace stillpoint {
namespace {

constexpr std::uint8_t kFree = 255;
constexpr std::uint8_t kTaken = 0;

}  // namespace

void FeatureMask::clear(cv::Size size) {
  image_.create(size, CV_8UC1);
  std::memset(image_.data, kFree, image_.total());  // cv::Mat::setTo asks for memory
}

bool FeatureMask::is_free(const cv::Point2f& pixel) const {
  const cv::Point nearest(cvRound(pixel.x), cvRound(pixel.y));
  const bool inside = nearest.x >= 0 && nearest.y >= 0 && nearest.x < image_.cols && nearest.y < image_.rows;
  return inside && image_.at<std::uint8_t>(nearest) == kFree;
}

void FeatureMask::take_circle(const cv::Point2f& pixel, int radius_px) {
  if (radius_px <= 0) return;
  cv::circle(image_, cv::Point(cvRound(pixel.x), cvRound(pixel.y)), radius_px, kTaken, cv::FILLED);
}

bool FeatureMask::claim(const cv::Point2f& pixel, int radius_px) {
  if (!is_free(pixel)) return false;
  take_circle(pixel, radius_px);
  return true;
}

}  // namespace stillpoint
