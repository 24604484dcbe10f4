// SPDX-License-Identifier: BSD-3-Clause
/// FAST corners of one grid cell. Paper Sec. III-B; Rosten and Drummond 2006.
#pragma once

#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "core/frontend/detect/fast_corners.h"
#include "core/frontend/detect/feature_mask.h"

namespace stillpoint {

struct FastCellSettings {
  int padding_px = 3;       ///< border around the cell included in the search; with 4 or more, non-maximum
                            ///< suppression considers corners beyond the edge of the cell as well
  int threshold = 10;       ///< intensity difference [grey levels]
  int min_distance_px = 0;  ///< between two returned corners
  std::size_t limit = 0;    ///< maximum number of corners
};

/// Stateless except for buffers that are reused between calls.
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
