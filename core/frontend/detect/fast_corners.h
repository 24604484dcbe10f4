// SPDX-License-Identifier: BSD-3-Clause
/// FAST corner detection with non-maximum suppression, in an image and in one cell of the grid. Paper Sec.
/// III-B; Rosten and Drummond 2006.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "core/frontend/detect/feature_detector.h"

namespace stillpoint {

struct Corner {
  cv::Point2f pixel;
  float score = 0.0F;  ///< highest threshold at which the pixel is still a corner [grey levels]
};

/// FAST corners of an image. Stateless except for buffers that are reused between calls.
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

struct FastCellSettings {
  int padding_px = 3;       ///< border around the cell included in the search; with 4 or more, non-maximum
                            ///< suppression considers corners beyond the edge of the cell as well
  int threshold = 10;       ///< intensity difference [grey levels]
  int min_distance_px = 0;  ///< between two returned corners
  std::size_t limit = 0;    ///< maximum number of corners
};

/// FAST corners of one grid cell. Stateless except for buffers that are reused between calls.
class FastCell {
 public:
  /// The strongest corners of a cell on free pixels, sorted by descending score; ties are ordered by row,
  /// then column. FAST corners are clustered, so each selected corner suppresses all corners closer than the
  /// minimum distance. Paper Sec. III-B: mask and non-maximum suppression combined.
  /// @param cell inside the image
  void search(const cv::Mat& gray, const FeatureMask& mask, const cv::Rect& cell,
              const FastCellSettings& settings);

  /// Result of the last search.
  [[nodiscard]] std::span<const Corner> corners() const { return selected_; }

 private:
  FastCorners fast_;
  std::vector<Corner> candidates_;
  std::vector<Corner> selected_;
};

/// Whether `pixel` is farther than `distance_px` from all `others`; always true for a distance of 0.
[[nodiscard]] bool is_separated(const cv::Point2f& pixel, std::span<const Corner> others, int distance_px);

}  // namespace stillpoint
