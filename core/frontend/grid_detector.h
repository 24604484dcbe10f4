// SPDX-License-Identifier: BSD-3-Clause
/// FAST corners where a grid over the picture lacks features. Paper Sec. III-B.
#pragma once

#include <cstdint>

#include "core/frontend/fast_cell.h"
#include "core/frontend/feature_detector.h"
#include "core/frontend/thread_pool.h"

namespace stillpoint {

/// Only cells with fewer features than their quota are searched, and not the ones that gave nothing the last
/// time they were (that once). Workers search the cells; the choice among what they found is made afterwards
/// in fixed order, so it is the same for any number of threads.
class GridDetector final : public FeatureDetector {
 public:
  /// @param max_features of the whole picture: the quota of a cell is its share of it, rounded up (the paper
  /// is
  ///   silent; rounded down, 56 cells could never hold more than 112 of 130)
  GridDetector(const GridDetectorConfig& config, int max_features);

  /// Fills the emptiest cells first, and among equally full ones the strongest corners. @throws InputError
  /// when the picture has fewer rows or columns than the grid
  [[nodiscard]] std::vector<cv::Point2f> detect(const DetectionRequest& request) override;
  void reset() override;

  /// Cells searched at the last call, row by row from 0; for tests and reports.
  [[nodiscard]] const std::vector<std::size_t>& searched_cells() const { return searched_; }

 private:
  [[nodiscard]] std::vector<int> features_per_cell(const DetectionRequest& request) const;
  void schedule(const std::vector<int>& features);
  [[nodiscard]] std::vector<std::vector<Corner>> search(const DetectionRequest& request,
                                                        const std::vector<int>& features);
  [[nodiscard]] std::vector<cv::Point2f> select(const DetectionRequest& request, std::vector<int> features,
                                                const std::vector<std::vector<Corner>>& found) const;
  [[nodiscard]] cv::Rect cell_rect(std::size_t cell, cv::Size size) const;
  [[nodiscard]] std::size_t cell_count() const { return barren_.size(); }

  GridDetectorConfig config_;
  int quota_;
  std::vector<std::uint8_t> barren_;  // per cell: gave nothing when last searched
  std::vector<std::size_t> searched_;
  ThreadPool pool_;
};

}  // namespace stillpoint
