// SPDX-License-Identifier: BSD-3-Clause
/// FAST corners of a picture, the weaker ones of neighbours left out. Paper Sec. III-B; Rosten and Drummond
/// 2006.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

struct Corner {
  cv::Point2f pixel;
  float score = 0.0F;  ///< highest threshold at which it still is a corner [grey levels]
};

/// Kept between searches for its memory only.
class FastCorners {
 public:
  /// Where 9 pixels in a row on the circle of 16 around a pixel are all brighter than it by more than
  /// `threshold`, or all darker; of neighbours only the one of the highest score. The same corners and scores
  /// as cv::FAST gives, row by row.
  /// @param gray CV_8UC1; no corners within 3 px of its edge
  /// @param threshold [grey levels]
  /// @return valid until the next call
  [[nodiscard]] const std::vector<Corner>& find(const cv::Mat& gray, int threshold);

 private:
  void keep_peaks(int row);

  std::array<std::vector<std::uint8_t>, 3> scores_;  ///< of the last rows; 0 = no corner
  std::vector<Corner> corners_;
};

}  // namespace stillpoint
