// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/klt.h"

#include <opencv2/video/tracking.hpp>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr double kConvergedPx = 0.01;  // step at which the iteration ends, as the published trackers have it

}  // namespace

void ImagePyramid::rebuild(const cv::Mat& gray, int window_px, int levels, PyramidKind kind) {
  const bool derivatives = kind == PyramidKind::kPicturesAndDerivatives;
  step_ = derivatives ? 2 : 1;
  constexpr bool kReuseInput = false;  // a border of the caller's own would be read as picture
  cv::buildOpticalFlowPyramid(gray, images_, cv::Size(window_px, window_px), levels - 1, derivatives,
                              cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, kReuseInput);
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
