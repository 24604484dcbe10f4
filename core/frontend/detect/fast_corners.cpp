// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/fast_corners.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <tuple>

#include <opencv2/core.hpp>

#include "core/frontend/detect/fast_kernel.h"

namespace stillpoint {
namespace {

constexpr int kRadius = 3;  // of the circle

/// Number of pixels skipped at once if none of them is a corner, which is the common case.
constexpr std::size_t kBlock = sizeof(std::uint64_t);

bool all_zero(const std::uint8_t* scores) {
  std::uint64_t block = 0;
  std::memcpy(&block, scores, kBlock);
  return block == 0;
}

}  // namespace

/// Processes `row`, the middle one of the last three rows.
void FastCorners::suppress_non_maxima(int row) {
  const auto& [above, center, below] = scores_;
  for (std::size_t x = kRadius; x + kRadius < center.size(); ++x) {
    if (x + kBlock <= center.size() && all_zero(&center[x])) {
      x += kBlock - 1;
      continue;
    }
    const std::uint8_t score = center[x];
    if (score == 0) continue;
    const bool is_maximum = score > center[x - 1] && score > center[x + 1] && score > above[x - 1] &&
                            score > above[x] && score > above[x + 1] && score > below[x - 1] &&
                            score > below[x] && score > below[x + 1];
    if (!is_maximum) continue;
    const cv::Point2f pixel(static_cast<float>(x), static_cast<float>(row));
    corners_.push_back({pixel, static_cast<float>(score)});
  }
}

const std::vector<Corner>& FastCorners::find(const cv::Mat& gray, int threshold) {
  corners_.clear();
  if (std::min(gray.cols, gray.rows) <= 2 * kRadius) return corners_;
  const auto width = static_cast<std::size_t>(gray.cols);
  for (std::vector<std::uint8_t>& row : scores_) row.assign(width, 0);
  for (int row = kRadius; row <= gray.rows - kRadius; ++row) {
    std::rotate(scores_.begin(), scores_.begin() + 1, scores_.end());
    const std::span scores = std::span(scores_.back()).subspan(kRadius, width - 2 * std::size_t{kRadius});
    if (row < gray.rows - kRadius) {
      score_fast_row(gray.ptr<std::uint8_t>(row) + kRadius, static_cast<std::ptrdiff_t>(gray.step[0]),
                     threshold, scores);
    } else {
      std::fill(scores.begin(), scores.end(), std::uint8_t{0});
    }
    suppress_non_maxima(row - 1);
  }
  return corners_;
}

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
