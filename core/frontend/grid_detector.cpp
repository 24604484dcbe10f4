// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/grid_detector.h"

#include <algorithm>
#include <functional>
#include <string>
#include <tuple>

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// First pixel of the `index`-th of `parts` stretches of a length: they differ by one pixel at most.
int cell_edge(int length, int parts, int index) { return length * index / parts; }

/// The stretch that holds a pixel: the inverse of `cell_edge`.
int cell_index(int length, int parts, int pixel) { return ((pixel + 1) * parts - 1) / length; }

}  // namespace

GridDetector::GridDetector(const GridDetectorConfig& config, int max_features)
    : config_(config),
      quota_((max_features + config.rows * config.cols - 1) / (config.rows * config.cols)),
      barren_(static_cast<std::size_t>(config.rows) * static_cast<std::size_t>(config.cols), 0),
      tracked_(barren_.size(), 0),
      searches_(barren_.size()),
      pool_(config.threads) {}

const std::vector<cv::Point2f>& GridDetector::detect(const DetectionRequest& request) {
  if (request.gray.rows < config_.rows || request.gray.cols < config_.cols) {
    throw InputError("frontend.grid", "more cells than pixels in a picture of " +
                                          std::to_string(request.gray.cols) + "x" +
                                          std::to_string(request.gray.rows) + "; lower rows and cols");
  }
  searched_.clear();
  candidates_.clear();
  taken_.clear();
  pixels_.clear();
  if (request.wanted <= 0) return pixels_;
  count_features(request);
  features_ = tracked_;
  schedule();
  for (int fill = 0; fill < quota_ + config_.spare_candidates; ++fill) {
    const bool enough = taken_.size() == static_cast<std::size_t>(request.wanted);
    if (enough && config_.stop_early) break;
    search(request, fill);
    take(request, fill);
  }
  for (const Corner& corner : taken_) pixels_.push_back(corner.pixel);
  return pixels_;
}

void GridDetector::reset() { std::fill(barren_.begin(), barren_.end(), std::uint8_t{0}); }

cv::Rect GridDetector::cell_rect(std::size_t cell, cv::Size size) const {
  const int row = static_cast<int>(cell) / config_.cols;
  const int col = static_cast<int>(cell) % config_.cols;
  return {
      cv::Point(cell_edge(size.width, config_.cols, col), cell_edge(size.height, config_.rows, row)),
      cv::Point(cell_edge(size.width, config_.cols, col + 1), cell_edge(size.height, config_.rows, row + 1))};
}

void GridDetector::count_features(const DetectionRequest& request) {
  std::fill(tracked_.begin(), tracked_.end(), 0);
  for (const cv::Point2f& pixel : request.tracked) {
    const int x = std::clamp(cvRound(pixel.x), 0, request.gray.cols - 1);
    const int y = std::clamp(cvRound(pixel.y), 0, request.gray.rows - 1);
    const int cell = cell_index(request.gray.rows, config_.rows, y) * config_.cols +
                     cell_index(request.gray.cols, config_.cols, x);
    ++tracked_[static_cast<std::size_t>(cell)];
  }
}

void GridDetector::schedule() {
  scheduled_.clear();
  for (std::size_t cell = 0; cell < cell_count(); ++cell) {
    const bool skipped = config_.skip_empty && barren_[cell] != 0;
    if (tracked_[cell] < quota_ && !skipped) scheduled_.push_back(cell);
    barren_[cell] = 0;
  }
}

/// Searches the scheduled cells that held `fill` features; all of them at once where none will be spared.
void GridDetector::search(const DetectionRequest& request, int fill) {
  const std::size_t first = searched_.size();
  for (const std::size_t cell : scheduled_) {
    const bool due = config_.stop_early ? tracked_[cell] == fill : fill == 0;
    if (due) searched_.push_back(cell);
  }
  const auto search_cell = [&](std::size_t i) {
    const std::size_t cell = searched_[first + i];
    const int lacking = quota_ - tracked_[cell];
    searches_[cell].search(request.gray, request.mask, cell_rect(cell, request.gray.size()),
                           {.padding_px = config_.padding_px,
                            .threshold = config_.fast_threshold,
                            .min_distance_px = request.min_distance_px,
                            .limit = static_cast<std::size_t>(lacking + config_.spare_candidates)});
  };
  pool_.for_each_index(searched_.size() - first, std::ref(search_cell));  // a copy would need memory
  for (std::size_t i = first; i < searched_.size(); ++i) {
    const std::size_t cell = searched_[i];
    barren_[cell] = searches_[cell].corners().empty() ? 1 : 0;
    int before = tracked_[cell];
    for (const Corner& corner : searches_[cell].corners()) candidates_.push_back({corner, cell, before++});
  }
}

/// Takes corners of cells that would have `fill` features before, the strongest first.
void GridDetector::take(const DetectionRequest& request, int fill) {
  const auto end = std::partition(candidates_.begin(), candidates_.end(),
                                  [fill](const Candidate& one) { return one.fill == fill; });
  std::sort(candidates_.begin(), end, [](const Candidate& a, const Candidate& b) {
    return std::tuple(-a.corner.score, a.cell) < std::tuple(-b.corner.score, b.cell);
  });
  for (auto candidate = candidates_.begin(); candidate != end; ++candidate) {
    if (taken_.size() == static_cast<std::size_t>(request.wanted)) break;
    if (features_[candidate->cell] >= quota_) continue;
    if (!is_apart(candidate->corner.pixel, taken_, request.min_distance_px)) continue;
    taken_.push_back(candidate->corner);
    ++features_[candidate->cell];
  }
}

}  // namespace stillpoint
