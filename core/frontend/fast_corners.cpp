// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/fast_corners.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>

#include "core/frontend/fast_kernel.h"

namespace stillpoint {
namespace {

constexpr int kRadius = 3;  // of the circle

/// Most pixels are no corners: so many are passed at once.
constexpr std::size_t kStretch = sizeof(std::uint64_t);

bool all_zero(const std::uint8_t* scores) {
  std::uint64_t stretch = 0;
  std::memcpy(&stretch, scores, kStretch);
  return stretch == 0;
}

}  // namespace

/// Of the middle one of the last three rows.
void FastCorners::keep_peaks(int row) {
  const auto& [above, here, below] = scores_;
  for (std::size_t x = kRadius; x + kRadius < here.size(); ++x) {
    if (x + kStretch <= here.size() && all_zero(&here[x])) {
      x += kStretch - 1;
      continue;
    }
    const std::uint8_t score = here[x];
    if (score == 0) continue;
    const bool peak = score > here[x - 1] && score > here[x + 1] && score > above[x - 1] &&
                      score > above[x] && score > above[x + 1] && score > below[x - 1] && score > below[x] &&
                      score > below[x + 1];
    if (!peak) continue;
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
    keep_peaks(row - 1);
  }
  return corners_;
}

}  // namespace stillpoint
