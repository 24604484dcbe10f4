// SPDX-License-Identifier: BSD-3-Clause
/// FAST corner detection with non-maximum suppression. Paper Sec. III-B; Rosten and Drummond 2006.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace stillpoint {

struct Corner {
  cv::Point2f pixel;
  float score = 0.0F;  ///< highest threshold at which the pixel is still a corner [grey levels]
};

/// Stateless except for buffers that are reused between calls.
class FastCorners {
 public:
  /// FAST-9: pixels for which 9 contiguous pixels on the circle of 16 around them are all brighter or all
  /// darker by more than `threshold`, after 3x3 non-maximum suppression by score. Corners and scores are
  /// identical to cv::FAST, in row-major order.
  /// @param gray CV_8UC1; there are no corners within 3 px of its edge
  /// @param threshold [grey levels]
  /// @return valid until the next call
  [[nodiscard]] const std::vector<Corner>& find(const cv::Mat& gray, int threshold);

 private:
  void suppress_non_maxima(int row);

  std::array<std::vector<std::uint8_t>, 3> scores_;  ///< of the last three rows; 0 = no corner
  std::vector<Corner> corners_;
};

}  // namespace stillpoint
