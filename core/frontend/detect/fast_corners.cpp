// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/fast_corners.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

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
    const std::span scores = std::span(scores_.back()).subspan(kRadius, width - 2 * kRadius);
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

}  // namespace stillpoint
