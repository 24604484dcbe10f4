// SPDX-License-Identifier: BSD-3-Clause
/// FAST corners in one cell of the grid. Paper Sec. III-B; Rosten and Drummond 2006.
#pragma once

#include <opencv2/core/types.hpp>
#include <span>
#include <vector>

#include "core/frontend/fast_corners.h"
#include "core/frontend/feature_mask.h"

namespace stillpoint {

struct FastCellSettings {
  int padding_px = 3;  ///< pixels around the cell that the test may look at; with 4 or more, corners beyond
                       ///< the cell's edge take part in non-maximum suppression as well
  int threshold = 10;  ///< brightness step [grey levels]
  int min_distance_px = 0;  ///< between two corners returned
  std::size_t limit = 0;    ///< most corners to return
};

/// Kept between searches for its memory only.
class FastCell {
 public:
  /// The strongest corners of a cell on free pixels, strongest first; of equal ones the upper, then the left
  /// one. FAST answers in clusters, so each corner taken shuts out those nearer than the minimum distance:
  /// the next ones are alternatives, not neighbours of the first.
  /// @param cell inside the picture
  void search(const cv::Mat& gray, const FeatureMask& mask, const cv::Rect& cell,
              const FastCellSettings& settings);

  /// What the last search found.
  [[nodiscard]] std::span<const Corner> corners() const { return chosen_; }

 private:
  FastCorners fast_;
  std::vector<Corner> free_;
  std::vector<Corner> chosen_;
};

/// Whether `pixel` is further than `distance_px` from all `others`; always true for a distance of 0.
[[nodiscard]] bool is_apart(const cv::Point2f& pixel, std::span<const Corner> others, int distance_px);

}  // namespace stillpoint
