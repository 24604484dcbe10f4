// SPDX-License-Identifier: BSD-3-Clause
/// Grid-based feature detection with FAST. Paper Sec. III-B.
#pragma once

#include <cstdint>

#include "core/frontend/detect/fast_corners.h"
#include "core/frontend/detect/feature_detector.h"
#include "core/frontend/detect/thread_pool.h"

namespace stillpoint {

/// The image is divided into rows x cols cells, each padded so that corners at its edge are found. Only cells
/// with fewer features than their quota are searched; a cell without corners (weak texture, or masked) is
/// skipped at the next detection, once. The cells are searched by a thread pool; the selection among the
/// candidates follows in a fixed order, so the result does not depend on the number of threads.
class GridDetector final : public FeatureDetector {
 public:
  /// @param max_features in the whole image; quota = ceil(max_features / number of cells). Not specified by
  ///   the paper; rounded down, 56 cells could hold at most 112 of 130 features.
  GridDetector(const GridDetectorConfig& config, int max_features);

  /// Selects corners for the cells with the fewest features first and, among equals, by descending score.
  /// `stop_early` selects the same corners, except that cells that were not searched are not recorded as
  /// empty for the next detection.
  /// @throws InputError if the image has fewer rows or columns than the grid
  [[nodiscard]] const std::vector<cv::Point2f>& detect(const DetectionRequest& request) override;
  void reset() override;

  /// Cells searched by the last call, in this order: row-major, or by feature count with `stop_early`. For
  /// tests and reports.
  [[nodiscard]] const std::vector<std::size_t>& searched_cells() const { return searched_; }

 private:
  struct Candidate {
    Corner corner;
    std::size_t cell = 0;
    int fill = 0;  // features of the cell before this one, if all its stronger candidates are selected
  };

  void count_features(const DetectionRequest& request);
  void schedule();
  void search(const DetectionRequest& request, int fill);
  void select(const DetectionRequest& request, int fill);
  [[nodiscard]] cv::Rect cell_rect(std::size_t cell, cv::Size size) const;
  [[nodiscard]] std::size_t cell_count() const { return empty_cells_.size(); }

  GridDetectorConfig config_;
  int quota_;
  std::vector<std::uint8_t> empty_cells_;  // per cell: gave nothing when last searched
  std::vector<int> tracked_per_cell_;      // per cell
  std::vector<int> features_per_cell_;     // per cell: tracked and taken
  std::vector<std::size_t> scheduled_;
  std::vector<std::size_t> searched_;
  std::vector<FastCell> cells_;  // per cell
  std::vector<Candidate> candidates_;
  std::vector<Corner> selected_;
  std::vector<cv::Point2f> pixels_;
  ThreadPool pool_;
};

}  // namespace stillpoint
