// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/patch_tracker.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr std::size_t kMaxLevels = 8;
constexpr std::size_t kBatch = 64;  // points handed to the kernel at a time

/// The views that the kernel takes of a pyramid.
struct Views {
  std::array<PatchImage, kMaxLevels> images;
  std::size_t count = 0;

  Views(const ImagePyramid& pyramid, int wanted)
      : count(std::min({kMaxLevels, static_cast<std::size_t>(wanted), pyramid.levels()})) {
    for (std::size_t level = 0; level < count; ++level) {
      const cv::Mat& image = pyramid.level(level);
      STILLPOINT_CHECK(has_border(image));
      images[level] = {.pixels = image.data,
                       .stride = static_cast<std::ptrdiff_t>(image.step[0]),
                       .width = image.cols,
                       .height = image.rows};
    }
  }
  [[nodiscard]] std::span<const PatchImage> view(std::size_t number) const {
    return std::span(images).first(number);
  }

 private:
  static bool has_border(const cv::Mat& image) {
    cv::Size whole;
    cv::Point offset;
    image.locateROI(whole, offset);
    const int below = std::min(whole.width - offset.x - image.cols, whole.height - offset.y - image.rows);
    return std::min({offset.x, offset.y, below}) >= kPatchReach;
  }
};

}  // namespace

KltResult follow_patches(const ImagePyramid& from, const ImagePyramid& to,
                         const std::vector<cv::Point2f>& points, const std::vector<cv::Point2f>& guesses,
                         int levels, const PatchSettings& settings, PatchTarget target, KltResult memory) {
  STILLPOINT_CHECK(points.size() == guesses.size());
  KltResult result = std::move(memory);
  result.pixels.resize(points.size());
  result.found.resize(points.size());
  const Views from_views(from, levels);
  const Views to_views(to, levels);
  const std::size_t shared = std::min(from_views.count, to_views.count);
  // cv::Point2f and PatchPoint are both two floats, but only copies may say so.
  std::array<PatchPoint, kBatch> centres;
  std::array<PatchPoint, kBatch> matches;
  for (std::size_t first = 0; first < points.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, points.size() - first);
    for (std::size_t i = 0; i < count; ++i) centres[i] = {points[first + i].x, points[first + i].y};
    for (std::size_t i = 0; i < count; ++i) matches[i] = {guesses[first + i].x, guesses[first + i].y};
    track_patches({.from = from_views.view(shared),
                   .to = to_views.view(shared),
                   .points = std::span(centres).first(count),
                   .matches = std::span(matches).first(count),
                   .found = std::span(result.found).subspan(first, count)},
                  settings, target);
    for (std::size_t i = 0; i < count; ++i) result.pixels[first + i] = {matches[i].x, matches[i].y};
  }
  return result;
}

}  // namespace stillpoint
