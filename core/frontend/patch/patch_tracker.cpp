// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/patch/patch_tracker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
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

namespace {

constexpr int kTileSide = 12;  // 8x8 patch, one more pixel for gradients, and two for interpolation
using Tile = std::array<std::uint8_t, std::size_t{kTileSide} * kTileSide>;

/// Position of the feature in a tile, per level. The kernel halves the coordinates of the finest level to
/// those of the next coarser one, relative to `kTileOrigin`.
constexpr std::array<float, 2> kTileCenter{5.5F, 4.75F};
constexpr std::array<int, 2> kTileOrigin{0, 2};
constexpr double kTileReach = 6.5;  // of a tile from its center, in both levels

constexpr int kFractionBits = 8;
constexpr int kOne = 1 << kFractionBits;

std::int32_t to_fixed(double value) { return static_cast<std::int32_t>(std::lround(value * kOne * kOne)); }

PatchImage view_of(const cv::Mat& image) {
  return {.pixels = image.data,
          .stride = static_cast<std::ptrdiff_t>(image.step[0]),
          .width = image.cols,
          .height = image.rows};
}

/// Bilinear interpolation of square images at fixed-point positions with 2 * kFractionBits fractional bits.
struct FixedPointSampler {
  const std::uint8_t* pixels;
  int stride;

  [[nodiscard]] std::uint8_t at(std::int32_t x, std::int32_t y) const {
    const std::int32_t fx = (x >> kFractionBits) & (kOne - 1), fy = (y >> kFractionBits) & (kOne - 1);
    const std::uint8_t* p =
        pixels + std::ptrdiff_t{y >> (2 * kFractionBits)} * stride + (x >> (2 * kFractionBits));
    const std::int32_t upper = p[0] * (kOne - fx) + p[1] * fx;
    const std::int32_t lower = p[stride] * (kOne - fx) + p[stride + 1] * fx;
    constexpr std::int32_t kHalf = kOne * kOne / 2;
    return static_cast<std::uint8_t>((upper * (kOne - fy) + lower * fy + kHalf) >> (2 * kFractionBits));
  }
};

/// Tile pixel (i, j) = sampler at center + A (i - c, j - c), c = `tile_center`.
Tile warp(const FixedPointSampler& sampler, PatchPoint center, const Eigen::Matrix2d& A, float tile_center) {
  const Eigen::Vector2d origin =
      Eigen::Vector2d(center.x, center.y) - A * Eigen::Vector2d::Constant(tile_center);
  const std::int32_t xx = to_fixed(A(0, 0)), xy = to_fixed(A(0, 1));
  const std::int32_t yx = to_fixed(A(1, 0)), yy = to_fixed(A(1, 1));
  const std::int32_t x0 = to_fixed(origin.x()), y0 = to_fixed(origin.y());
  Tile tile;
  std::uint8_t* out = tile.data();
  for (int j = 0; j < kTileSide; ++j) {
    for (int i = 0; i < kTileSide; ++i) *out++ = sampler.at(x0 + xx * i + xy * j, y0 + yx * i + yy * j);
  }
  return tile;
}

PatchImage view_of(const Tile& tile, int origin) {
  return {.pixels = tile.data() + std::ptrdiff_t{origin} * (kTileSide + 1),
          .stride = kTileSide,
          .width = kTileSide - origin,
          .height = kTileSide - origin};
}

}  // namespace

void TrackTemplate::capture(const ImagePyramid& pyramid, PatchPoint pixel) {
  levels_ = static_cast<int>(std::min(level_.size(), pyramid.levels()));
  float scale = 1.0F;
  for (int i = 0; i < levels_; ++i, scale *= 0.5F) {
    const auto index = static_cast<std::size_t>(i);
    const PatchImage image = view_of(pyramid.level(index));
    const PatchPoint at{scale * pixel.x, scale * pixel.y};
    const int left = static_cast<int>(std::floor(at.x)) - kSide / 2 + 1;
    const int top = static_cast<int>(std::floor(at.y)) - kSide / 2 + 1;
    Level& level = level_[index];
    level.center = {at.x - static_cast<float>(left), at.y - static_cast<float>(top)};
    std::uint8_t* out = level.pixels.data();
    for (int y = top; y < top + kSide; ++y) {
      const std::uint8_t* row =
          image.pixels + std::clamp(y, -kPatchReach, image.height - 1 + kPatchReach) * image.stride;
      for (int x = left; x < left + kSide; ++x)
        *out++ = row[std::clamp(x, -kPatchReach, image.width - 1 + kPatchReach)];
    }
  }
}

std::optional<PatchPoint> TrackTemplate::align(const ImagePyramid& pyramid,
                                               const Eigen::Matrix2d& A_template_image,
                                               PatchPoint initial_guess,
                                               const AlignmentSettings& settings) const {
  constexpr int kLargestOffset = kSide / 2 - 1;
  constexpr double kMaxStretch = kLargestOffset / kTileReach;
  const bool fits =
      A_template_image.allFinite() && A_template_image.cwiseAbs().rowwise().sum().maxCoeff() <= kMaxStretch;
  const auto levels = static_cast<std::size_t>(std::min(levels_, static_cast<int>(pyramid.levels())));
  if (!fits || levels == 0) return std::nullopt;
  std::array<Tile, 2> tiles;
  std::array<PatchImage, 2> from, to;
  for (std::size_t i = 0; i < levels; ++i) {
    tiles[i] = warp({level_[i].pixels.data(), kSide}, level_[i].center, A_template_image, kTileCenter[i]);
    from[i] = view_of(tiles[i], kTileOrigin[i]);
    to[i] = view_of(pyramid.level(i));
  }
  const PatchPoint center{kTileCenter[0], kTileCenter[0]};
  PatchPoint match = initial_guess;
  std::uint8_t found = 0;
  track_patches({.from = std::span(from).first(levels),
                 .to = std::span(to).first(levels),
                 .points = std::span(&center, 1),
                 .matches = std::span(&match, 1),
                 .found = std::span(&found, 1)},
                settings.search);
  const float dx = match.x - initial_guess.x, dy = match.y - initial_guess.y;
  if (found == 0 || !(dx * dx + dy * dy <= settings.max_shift_px * settings.max_shift_px))
    return std::nullopt;
  return match;
}

}  // namespace stillpoint
