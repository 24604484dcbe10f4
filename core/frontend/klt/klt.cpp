// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/klt/klt.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include <opencv2/video/tracking.hpp>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr int kReach = 2;  // half width of the filter

}  // namespace

void reflect_border(cv::Mat image, int border_px) {
  const int width = image.cols;
  const auto stride = static_cast<std::ptrdiff_t>(image.step[0]);
  for (int y = 0; y < image.rows; ++y) {
    std::uint8_t* const row = image.ptr<std::uint8_t>(y);
    for (int k = 1; k <= border_px; ++k) {
      row[-k] = row[k];
      row[width - 1 + k] = row[width - 1 - k];
    }
  }
  const int padded_width = width + 2 * border_px;
  std::uint8_t* const first = image.data - border_px;
  std::uint8_t* const last = first + (image.rows - 1) * stride;
  for (int k = 1; k <= border_px; ++k) {
    std::memcpy(first - k * stride, first + k * stride, static_cast<std::size_t>(padded_width));
    std::memcpy(last + k * stride, last - k * stride, static_cast<std::size_t>(padded_width));
  }
}

void pyr_down(const cv::Mat& from, cv::Mat to, std::vector<std::uint16_t>& column_sums) {
  const auto stride = static_cast<std::ptrdiff_t>(from.step[0]);
  const std::ptrdiff_t columns = from.cols + 2 * kReach;
  column_sums.resize(static_cast<std::size_t>(columns + 1));
  for (int y = 0; y < to.rows; ++y) {
    const std::uint8_t* const middle = from.data + 2 * stride * y - kReach;
    for (std::ptrdiff_t x = 0; x < columns; ++x) {  // at most 16 * 255
      column_sums[static_cast<std::size_t>(x)] =
          static_cast<std::uint16_t>(middle[x - 2 * stride] + middle[x + 2 * stride] +
                                     4 * (middle[x - stride] + middle[x + stride]) + 6 * middle[x]);
    }
    std::uint8_t* const row = to.ptr<std::uint8_t>(y);
    const std::uint16_t* sum = column_sums.data();
    for (int x = 0; x < to.cols; ++x, sum += 2) {  // at most 256 * 255, and rounded
      row[x] = static_cast<std::uint8_t>((sum[0] + sum[4] + 4 * (sum[1] + sum[3]) + 6 * sum[2] + 128) >> 8);
    }
  }
}

namespace {

constexpr double kConvergedPx = 0.01;  // step that ends the iteration, as in the published trackers

/// An image inside a larger allocation, with a border of `border_px` around it.
cv::Mat bordered_image(const cv::Size& size, int border_px) {
  const cv::Mat whole(size + cv::Size(2 * border_px, 2 * border_px), CV_8UC1);
  return whole(cv::Rect({border_px, border_px}, size));
}

}  // namespace

void ImagePyramid::rebuild(const cv::Mat& gray, int window_px, int levels, PyramidKind kind) {
  if (kind == PyramidKind::kImages) {
    rebuild_images(gray, window_px, levels);
    return;
  }
  images_per_level_ = 2;
  constexpr bool kDerivatives = true;
  constexpr bool kReuseInput = false;  // otherwise pixels around a submatrix would be used as border
  cv::buildOpticalFlowPyramid(gray, images_, cv::Size(window_px, window_px), levels - 1, kDerivatives,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, kReuseInput);
}

void ImagePyramid::rebuild_images(const cv::Mat& gray, int border_px, int levels) {
  const bool reusable = images_per_level_ == 1 && border_px_ == border_px && !images_.empty() &&
                        images_[0].size() == gray.size();
  if (!reusable) images_.clear();
  images_per_level_ = 1;
  border_px_ = border_px;
  cv::Size size = gray.size();
  std::size_t level = 0;
  for (; level < static_cast<std::size_t>(levels); ++level) {
    if (level > 0 && std::min(size.width, size.height) <= border_px) break;
    if (level == images_.size()) images_.push_back(bordered_image(size, border_px));
    if (level == 0) {
      gray.copyTo(images_[0]);
    } else {
      pyr_down(images_[level - 1], images_[level], column_sums_);
    }
    reflect_border(images_[level], border_px);
    size = cv::Size((size.width + 1) / 2, (size.height + 1) / 2);
  }
  images_.resize(level);
}

KltResult track_points_klt(const TrackingRequest& request, const KltSettings& settings) {
  STILLPOINT_CHECK(request.points.size() == request.initial_guesses.size());
  KltResult result{.pixels = request.initial_guesses, .found = {}};
  if (request.points.empty()) return result;
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, settings.max_iterations,
                              kConvergedPx);
  cv::calcOpticalFlowPyrLK(request.from.images(), request.to.images(), request.points, result.pixels,
                           result.found, cv::noArray(), cv::Size(settings.window_px, settings.window_px),
                           request.levels - 1, stop, cv::OPTFLOW_USE_INITIAL_FLOW);
  return result;
}

}  // namespace stillpoint
