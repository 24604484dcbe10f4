// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/grid_detector.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "core/base/error.h"

namespace stillpoint {
namespace {

/// First pixel of the `index`-th of `parts` stretches of a length: they differ by one pixel at most.
int cell_edge(int length, int parts, int index) { return length * index / parts; }

/// The stretch that holds a pixel: the inverse of `cell_edge`.
int cell_index(int length, int parts, int pixel) { return ((pixel + 1) * parts - 1) / length; }

struct Candidate {
  Corner corner;
  std::size_t cell = 0;
  int fill = 0;  // features the cell would have before this one, if all stronger ones of it were taken
};

bool comes_first(const Candidate& a, const Candidate& b) {
  return std::tuple(a.fill, -a.corner.score, a.cell) < std::tuple(b.fill, -b.corner.score, b.cell);
}

}  // namespace

GridDetector::GridDetector(const GridDetectorConfig& config, int max_features)
    : config_(config),
      quota_((max_features + config.rows * config.cols - 1) / (config.rows * config.cols)),
      barren_(static_cast<std::size_t>(config.rows) * static_cast<std::size_t>(config.cols), 0),
      pool_(config.threads) {}

std::vector<cv::Point2f> GridDetector::detect(const DetectionRequest& request) {
  if (request.gray.rows < config_.rows || request.gray.cols < config_.cols) {
    throw InputError("frontend.grid", "more cells than pixels in a picture of " +
                                          std::to_string(request.gray.cols) + "x" +
                                          std::to_string(request.gray.rows) + "; lower rows and cols");
  }
  searched_.clear();
  if (request.wanted <= 0) return {};
  const std::vector<int> features = features_per_cell(request);
  schedule(features);
  const std::vector<std::vector<Corner>> found = search(request, features);
  for (std::size_t i = 0; i < searched_.size(); ++i) barren_[searched_[i]] = found[i].empty() ? 1 : 0;
  return select(request, features, found);
}

void GridDetector::reset() { std::fill(barren_.begin(), barren_.end(), std::uint8_t{0}); }

cv::Rect GridDetector::cell_rect(std::size_t cell, cv::Size size) const {
  const int row = static_cast<int>(cell) / config_.cols;
  const int col = static_cast<int>(cell) % config_.cols;
  return {
      cv::Point(cell_edge(size.width, config_.cols, col), cell_edge(size.height, config_.rows, row)),
      cv::Point(cell_edge(size.width, config_.cols, col + 1), cell_edge(size.height, config_.rows, row + 1))};
}

std::vector<int> GridDetector::features_per_cell(const DetectionRequest& request) const {
  std::vector<int> features(cell_count(), 0);
  for (const cv::Point2f& pixel : request.tracked) {
    const int x = std::clamp(cvRound(pixel.x), 0, request.gray.cols - 1);
    const int y = std::clamp(cvRound(pixel.y), 0, request.gray.rows - 1);
    const int cell = cell_index(request.gray.rows, config_.rows, y) * config_.cols +
                     cell_index(request.gray.cols, config_.cols, x);
    ++features[static_cast<std::size_t>(cell)];
  }
  return features;
}

void GridDetector::schedule(const std::vector<int>& features) {
  for (std::size_t cell = 0; cell < cell_count(); ++cell) {
    const bool skipped = config_.skip_empty && barren_[cell] != 0;
    if (features[cell] < quota_ && !skipped) searched_.push_back(cell);
    barren_[cell] = 0;
  }
}

std::vector<std::vector<Corner>> GridDetector::search(const DetectionRequest& request,
                                                      const std::vector<int>& features) {
  std::vector<std::vector<Corner>> found(searched_.size());
  pool_.for_each_index(searched_.size(), [&](std::size_t i) {
    const int lacking = quota_ - features[searched_[i]];
    found[i] = fast_corners_in_cell(request.gray, request.mask, cell_rect(searched_[i], request.gray.size()),
                                    {.padding_px = config_.padding_px,
                                     .threshold = config_.fast_threshold,
                                     .min_distance_px = request.min_distance_px,
                                     .limit = static_cast<std::size_t>(lacking + config_.spare_candidates)});
  });
  return found;
}

std::vector<cv::Point2f> GridDetector::select(const DetectionRequest& request, std::vector<int> features,
                                              const std::vector<std::vector<Corner>>& found) const {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < found.size(); ++i) {
    int fill = features[searched_[i]];
    for (const Corner& corner : found[i]) candidates.push_back({corner, searched_[i], fill++});
  }
  std::sort(candidates.begin(), candidates.end(), comes_first);

  std::vector<Corner> taken;
  for (const Candidate& candidate : candidates) {
    if (taken.size() == static_cast<std::size_t>(request.wanted)) break;
    if (features[candidate.cell] >= quota_) continue;
    if (!is_apart(candidate.corner.pixel, taken, request.min_distance_px)) continue;
    taken.push_back(candidate.corner);
    ++features[candidate.cell];
  }
  std::vector<cv::Point2f> pixels;
  for (const Corner& corner : taken) pixels.push_back(corner.pixel);
  return pixels;
}

}  // namespace stillpoint
