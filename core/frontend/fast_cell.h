// SPDX-License-Identifier: BSD-3-Clause
/// FAST corners in one cell of the grid. Paper Sec. III-B; Rosten and Drummond 2006.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

#include "core/frontend/feature_mask.h"

namespace stillpoint {

struct Corner {
  cv::Point2f pixel;
  float score = 0.0F;  ///< highest threshold at which it still is a corner [grey levels]
};

struct FastCellSettings {
  int padding_px = 3;  ///< pixels around the cell that the test may look at; with 4 or more, corners beyond
                       ///< the cell's edge take part in non-maximum suppression as well
  int threshold = 10;  ///< brightness step [grey levels]
  int min_distance_px = 0;  ///< between two corners returned
  std::size_t limit = 0;    ///< most corners to return
};

/// The strongest corners of a cell on free pixels, strongest first; of equal ones the upper, then the left
/// one. FAST answers in clusters, so each corner taken shuts out those nearer than the minimum distance: the
/// next ones are alternatives, not neighbours of the first.
/// @param cell inside the picture
[[nodiscard]] std::vector<Corner> fast_corners_in_cell(const cv::Mat& gray, const FeatureMask& mask,
                                                       const cv::Rect& cell,
                                                       const FastCellSettings& settings);

/// Whether `pixel` is further than `distance_px` from all `others`; always true for a distance of 0.
[[nodiscard]] bool is_apart(const cv::Point2f& pixel, const std::vector<Corner>& others, int distance_px);

}  // namespace stillpoint
