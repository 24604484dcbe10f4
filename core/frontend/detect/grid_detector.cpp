// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/grid_detector.h"

#include <algorithm>
#include <functional>
#include <string>
#include <tuple>

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// First pixel of the `index`-th of `parts` intervals of `length`; their sizes differ by at most one pixel.
int cell_edge(int length, int parts, int index) { return length * index / parts; }

/// Index of the interval that contains a pixel: the inverse of `cell_edge`.
int cell_index(int length, int parts, int pixel) { return ((pixel + 1) * parts - 1) / length; }

/// Candidates that a cell keeps beyond its quota, in place of those that are too close to one of another
/// cell.
constexpr int kExtraCandidates = 2;

}  // namespace

GridDetector::GridDetector(const GridDetectorConfig& config, int max_features)
    : config_(config),
      quota_((max_features + config.rows * config.cols - 1) / (config.rows * config.cols)),
      empty_cells_(static_cast<std::size_t>(config.rows) * static_cast<std::size_t>(config.cols), 0),
      tracked_per_cell_(empty_cells_.size(), 0),
      cells_(empty_cells_.size()),
      pool_(config.threads) {}

const std::vector<cv::Point2f>& GridDetector::detect(const DetectionRequest& request) {
  if (request.gray.rows < config_.rows || request.gray.cols < config_.cols) {
    throw InputError("frontend.grid", "more cells than pixels in an image of " +
                                          std::to_string(request.gray.cols) + "x" +
                                          std::to_string(request.gray.rows) + "; reduce rows and cols");
  }
  searched_.clear();
  candidates_.clear();
  selected_.clear();
  pixels_.clear();
  if (request.wanted <= 0) return pixels_;
  count_features(request);
  features_per_cell_ = tracked_per_cell_;
  schedule();
  for (int fill = 0; fill < quota_ + kExtraCandidates; ++fill) {
    const bool enough = selected_.size() == static_cast<std::size_t>(request.wanted);
    if (enough && config_.stop_early) break;
    search(request, fill);
    select(request, fill);
  }
  for (const Corner& corner : selected_) pixels_.push_back(corner.pixel);
  return pixels_;
}

void GridDetector::reset() { std::fill(empty_cells_.begin(), empty_cells_.end(), std::uint8_t{0}); }

cv::Rect GridDetector::cell_rect(std::size_t cell, cv::Size size) const {
  const int row = static_cast<int>(cell) / config_.cols;
  const int col = static_cast<int>(cell) % config_.cols;
  return {
      cv::Point(cell_edge(size.width, config_.cols, col), cell_edge(size.height, config_.rows, row)),
      cv::Point(cell_edge(size.width, config_.cols, col + 1), cell_edge(size.height, config_.rows, row + 1))};
}

void GridDetector::count_features(const DetectionRequest& request) {
  std::fill(tracked_per_cell_.begin(), tracked_per_cell_.end(), 0);
  for (const cv::Point2f& pixel : request.tracked) {
    const int x = std::clamp(cvRound(pixel.x), 0, request.gray.cols - 1);
    const int y = std::clamp(cvRound(pixel.y), 0, request.gray.rows - 1);
    const int cell = cell_index(request.gray.rows, config_.rows, y) * config_.cols +
                     cell_index(request.gray.cols, config_.cols, x);
    ++tracked_per_cell_[static_cast<std::size_t>(cell)];
  }
}

void GridDetector::schedule() {
  scheduled_.clear();
  for (std::size_t cell = 0; cell < cell_count(); ++cell) {
    const bool skipped = empty_cells_[cell] != 0;
    if (tracked_per_cell_[cell] < quota_ && !skipped) scheduled_.push_back(cell);
    empty_cells_[cell] = 0;
  }
}

/// Searches the scheduled cells with `fill` tracked features; without `stop_early`, all of them at fill 0.
void GridDetector::search(const DetectionRequest& request, int fill) {
  const std::size_t first = searched_.size();
  for (const std::size_t cell : scheduled_) {
    const bool due = config_.stop_early ? tracked_per_cell_[cell] == fill : fill == 0;
    if (due) searched_.push_back(cell);
  }
  const auto search_cell = [&](std::size_t i) {
    const std::size_t cell = searched_[first + i];
    const int missing = quota_ - tracked_per_cell_[cell];
    cells_[cell].search(request.gray, request.mask, cell_rect(cell, request.gray.size()),
                        {.threshold = config_.fast_threshold,
                         .min_distance_px = request.min_distance_px,
                         .limit = static_cast<std::size_t>(missing + kExtraCandidates)});
  };
  pool_.for_each_index(searched_.size() - first, std::ref(search_cell));  // copying it would allocate
  for (std::size_t i = first; i < searched_.size(); ++i) {
    const std::size_t cell = searched_[i];
    empty_cells_[cell] = cells_[cell].corners().empty() ? 1 : 0;
    int before = tracked_per_cell_[cell];
    for (const Corner& corner : cells_[cell].corners()) candidates_.push_back({corner, cell, before++});
  }
}

/// Selects candidates at position `fill` of their cells, by descending score.
void GridDetector::select(const DetectionRequest& request, int fill) {
  const auto end = std::partition(candidates_.begin(), candidates_.end(),
                                  [fill](const Candidate& one) { return one.fill == fill; });
  std::sort(candidates_.begin(), end, [](const Candidate& a, const Candidate& b) {
    return std::tuple(-a.corner.score, a.cell) < std::tuple(-b.corner.score, b.cell);
  });
  for (auto candidate = candidates_.begin(); candidate != end; ++candidate) {
    if (selected_.size() == static_cast<std::size_t>(request.wanted)) break;
    if (features_per_cell_[candidate->cell] >= quota_) continue;
    if (!is_separated(candidate->corner.pixel, selected_, request.min_distance_px)) continue;
    selected_.push_back(candidate->corner);
    ++features_per_cell_[candidate->cell];
  }
}

}  // namespace stillpoint
