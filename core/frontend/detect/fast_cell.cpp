// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/fast_cell.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <tuple>

namespace stillpoint {
namespace {

bool is_stronger(const Corner& a, const Corner& b) {
  return std::tuple(-a.score, a.pixel.y, a.pixel.x) < std::tuple(-b.score, b.pixel.y, b.pixel.x);
}

}  // namespace

void FastCell::search(const cv::Mat& gray, const FeatureMask& mask, const cv::Rect& cell,
                      const FastCellSettings& settings) {
  selected_.clear();
  if (cv::countNonZero(mask.image()(cell)) == 0) return;
  const cv::Point margin(settings.padding_px, settings.padding_px);
  const cv::Rect padded = cv::Rect(cell.tl() - margin, cell.br() + margin) & cv::Rect({0, 0}, gray.size());
  candidates_.clear();
  for (Corner corner : fast_.find(gray(padded), settings.threshold)) {
    corner.pixel += cv::Point2f(padded.tl());
    if (cell.contains(cv::Point(corner.pixel)) && mask.is_free(corner.pixel)) candidates_.push_back(corner);
  }
  std::sort(candidates_.begin(), candidates_.end(), is_stronger);
  for (const Corner& corner : candidates_) {
    if (selected_.size() == settings.limit) break;
    if (is_separated(corner.pixel, selected_, settings.min_distance_px)) selected_.push_back(corner);
  }
}

bool is_separated(const cv::Point2f& pixel, std::span<const Corner> others, int distance_px) {
  const double squared_distance = static_cast<double>(distance_px) * distance_px;
  return distance_px == 0 || std::all_of(others.begin(), others.end(), [&](const Corner& other) {
           const cv::Point2f offset = other.pixel - pixel;
           return offset.ddot(offset) > squared_distance;
         });
}

}  // namespace stillpoint
