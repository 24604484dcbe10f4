// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/klt.h"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

#include "core/base/error.h"
#include "core/frontend/half_picture.h"

namespace stillpoint {
namespace {

constexpr double kConvergedPx = 0.01;  // step at which the iteration ends, as the published trackers have it

/// A picture with memory around it.
cv::Mat bordered_picture(const cv::Size& size, int border_px) {
  const cv::Mat whole(size + cv::Size(2 * border_px, 2 * border_px), CV_8UC1);
  return whole(cv::Rect({border_px, border_px}, size));
}

}  // namespace

void ImagePyramid::rebuild(const cv::Mat& gray, int window_px, int levels, PyramidKind kind) {
  if (kind == PyramidKind::kPictures) {
    rebuild_pictures(gray, window_px, levels);
    return;
  }
  step_ = 2;
  constexpr bool kDerivatives = true;
  constexpr bool kReuseInput = false;  // a border of the caller's own would be read as picture
  cv::buildOpticalFlowPyramid(gray, images_, cv::Size(window_px, window_px), levels - 1, kDerivatives,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, kReuseInput);
}

void ImagePyramid::rebuild_pictures(const cv::Mat& gray, int border_px, int levels) {
  const bool same =
      step_ == 1 && border_px_ == border_px && !images_.empty() && images_[0].size() == gray.size();
  if (!same) images_.clear();
  step_ = 1;
  border_px_ = border_px;
  cv::Size size = gray.size();
  std::size_t level = 0;
  for (; level < static_cast<std::size_t>(levels); ++level) {
    if (level > 0 && std::min(size.width, size.height) <= border_px) break;
    if (level == images_.size()) images_.push_back(bordered_picture(size, border_px));
    if (level == 0) {
      gray.copyTo(images_[0]);
    } else {
      halve(images_[level - 1], images_[level], sums_);
    }
    mirror_border(images_[level], border_px);
    size = cv::Size((size.width + 1) / 2, (size.height + 1) / 2);
  }
  images_.resize(level);
}

KltResult follow_points(const ImagePyramid& from, const ImagePyramid& to,
                        const std::vector<cv::Point2f>& points, const std::vector<cv::Point2f>& guesses,
                        const KltSettings& settings) {
  STILLPOINT_CHECK(points.size() == guesses.size());
  KltResult result{.pixels = guesses, .found = {}};
  if (points.empty()) return result;
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, settings.max_iterations,
                              kConvergedPx);
  cv::calcOpticalFlowPyrLK(from.images(), to.images(), points, result.pixels, result.found, cv::noArray(),
                           cv::Size(settings.window_px, settings.window_px), settings.levels - 1, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  return result;
}

KltResult keep_returning(const std::vector<cv::Point2f>& points, KltResult forward, const KltResult& back,
                         double tolerance_px) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool came_back = back.found[i] != 0 && cv::norm(back.pixels[i] - points[i]) <= tolerance_px;
    if (!came_back) forward.found[i] = 0;
  }
  return forward;
}

}  // namespace stillpoint
