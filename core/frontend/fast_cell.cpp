// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/fast_cell.h"

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <tuple>

namespace stillpoint {
namespace {

bool stronger(const Corner& a, const Corner& b) {
  return std::tuple(-a.score, a.pixel.y, a.pixel.x) < std::tuple(-b.score, b.pixel.y, b.pixel.x);
}

std::vector<Corner> free_corners(const cv::Mat& gray, const FeatureMask& mask, const cv::Rect& cell,
                                 const FastCellSettings& settings) {
  const cv::Point margin(settings.padding_px, settings.padding_px);
  const cv::Rect padded = cv::Rect(cell.tl() - margin, cell.br() + margin) & cv::Rect({0, 0}, gray.size());
  constexpr bool kNonMaximumSuppression = true;
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(gray(padded), keypoints, settings.threshold, kNonMaximumSuppression);

  std::vector<Corner> corners;
  for (const cv::KeyPoint& keypoint : keypoints) {
    const cv::Point2f pixel = keypoint.pt + cv::Point2f(padded.tl());
    if (cell.contains(cv::Point(pixel)) && mask.is_free(pixel)) corners.push_back({pixel, keypoint.response});
  }
  return corners;
}

}  // namespace

std::vector<Corner> fast_corners_in_cell(const cv::Mat& gray, const FeatureMask& mask, const cv::Rect& cell,
                                         const FastCellSettings& settings) {
  std::vector<Corner> chosen;
  if (cv::countNonZero(mask.image()(cell)) == 0) return chosen;
  std::vector<Corner> corners = free_corners(gray, mask, cell, settings);
  std::sort(corners.begin(), corners.end(), stronger);
  for (const Corner& corner : corners) {
    if (chosen.size() == settings.limit) break;
    if (is_apart(corner.pixel, chosen, settings.min_distance_px)) chosen.push_back(corner);
  }
  return chosen;
}

bool is_apart(const cv::Point2f& pixel, const std::vector<Corner>& others, int distance_px) {
  const double squared_distance = static_cast<double>(distance_px) * distance_px;
  return distance_px == 0 || std::all_of(others.begin(), others.end(), [&](const Corner& other) {
           const cv::Point2f offset = other.pixel - pixel;
           return offset.ddot(offset) > squared_distance;
         });
}

}  // namespace stillpoint
