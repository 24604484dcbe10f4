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

  /// Fills the emptiest cells first, and among equally full ones the strongest corners. With `stop_early`
  /// that choice is the same but for cells that are passed over instead of being found barren. @throws
  /// InputError when the picture has fewer rows or columns than the grid
  [[nodiscard]] const std::vector<cv::Point2f>& detect(const DetectionRequest& request) override;
  void reset() override;

  /// Cells searched at the last call, in that order: row by row from 0, the emptiest first with `stop_early`;
  /// for tests and reports.
  [[nodiscard]] const std::vector<std::size_t>& searched_cells() const { return searched_; }

 private:
  struct Candidate {
    Corner corner;
    std::size_t cell = 0;
    int fill = 0;  // features the cell would have before this one, if all stronger ones of it were taken
  };

  void count_features(const DetectionRequest& request);
  void schedule();
  void search(const DetectionRequest& request, int fill);
  void take(const DetectionRequest& request, int fill);
  [[nodiscard]] cv::Rect cell_rect(std::size_t cell, cv::Size size) const;
  [[nodiscard]] std::size_t cell_count() const { return barren_.size(); }

  GridDetectorConfig config_;
  int quota_;
  std::vector<std::uint8_t> barren_;  // per cell: gave nothing when last searched
  std::vector<int> tracked_;          // per cell
  std::vector<int> features_;         // per cell: tracked and taken
  std::vector<std::size_t> scheduled_;
  std::vector<std::size_t> searched_;
  std::vector<FastCell> searches_;  // per cell
  std::vector<Candidate> candidates_;
  std::vector<Corner> taken_;
  std::vector<cv::Point2f> pixels_;
  ThreadPool pool_;
};

}  // namespace stillpoint
