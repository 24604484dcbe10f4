// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/patch/patch_tracker.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMaxLevels = 8;
constexpr std::size_t kBatch = 64;  // points handed to the kernel at a time

/// A pyramid as the array of level views that the kernel reads.
struct PyramidView {
  std::array<PatchImage, kMaxLevels> images;
  std::size_t count = 0;

  PyramidView(const ImagePyramid& pyramid, int max_levels)
      : count(std::min({kMaxLevels, static_cast<std::size_t>(max_levels), pyramid.levels()})) {
    for (std::size_t level = 0; level < count; ++level) {
      const cv::Mat& image = pyramid.level(level);
      STILLPOINT_CHECK(has_border(image));
      images[level] = {.pixels = image.data,
                       .stride = static_cast<std::ptrdiff_t>(image.step[0]),
                       .width = image.cols,
                       .height = image.rows};
    }
  }
  [[nodiscard]] std::span<const PatchImage> levels(std::size_t level_count) const {
    return std::span(images).first(level_count);
  }

 private:
  static bool has_border(const cv::Mat& image) {
    cv::Size allocated;
    cv::Point offset;
    image.locateROI(allocated, offset);
    const int far_side =
        std::min(allocated.width - offset.x - image.cols, allocated.height - offset.y - image.rows);
    return std::min({offset.x, offset.y, far_side}) >= kPatchReach;
  }
};

}  // namespace

KltResult track_points_patch(const TrackingRequest& request, const PatchSettings& settings,
                             PatchTarget target, KltResult recycled) {
  const std::vector<cv::Point2f>& points = request.points;
  const std::vector<cv::Point2f>& initial_guesses = request.initial_guesses;
  STILLPOINT_CHECK(points.size() == initial_guesses.size());
  KltResult result = std::move(recycled);
  result.pixels.resize(points.size());
  result.found.resize(points.size());
  const PyramidView from_views(request.from, request.levels);
  const PyramidView to_views(request.to, request.levels);
  const std::size_t common_levels = std::min(from_views.count, to_views.count);
  // cv::Point2f and PatchPoint have the same layout, but a cast would violate strict aliasing.
  std::array<PatchPoint, kBatch> centers;
  std::array<PatchPoint, kBatch> matches;
  for (std::size_t first = 0; first < points.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, points.size() - first);
    for (std::size_t i = 0; i < count; ++i) centers[i] = {points[first + i].x, points[first + i].y};
    for (std::size_t i = 0; i < count; ++i)
      matches[i] = {initial_guesses[first + i].x, initial_guesses[first + i].y};
    track_patches({.from = from_views.levels(common_levels),
                   .to = to_views.levels(common_levels),
                   .points = std::span(centers).first(count),
                   .matches = std::span(matches).first(count),
                   .found = std::span(result.found).subspan(first, count)},
                  settings, target);
    for (std::size_t i = 0; i < count; ++i) result.pixels[first + i] = {matches[i].x, matches[i].y};
  }
  return result;
}

}  // namespace stillpoint
