// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/feature_detector.h"

#include <cstdint>
#include <cstring>

#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "core/frontend/detect/grid_detector.h"

namespace stillpoint {
namespace {

constexpr std::uint8_t kFree = 255;
constexpr std::uint8_t kOccupied = 0;

/// Shi-Tomasi: smallest strength of a corner relative to the strongest one of the image; as in VINS-Mono.
constexpr double kQuality = 0.01;

}  // namespace

void FeatureMask::clear(cv::Size size) {
  image_.create(size, CV_8UC1);
  std::memset(image_.data, kFree, image_.total());  // cv::Mat::setTo allocates
}

bool FeatureMask::is_free(const cv::Point2f& pixel) const {
  const cv::Point nearest(cvRound(pixel.x), cvRound(pixel.y));
  const bool inside = nearest.x >= 0 && nearest.y >= 0 && nearest.x < image_.cols && nearest.y < image_.rows;
  return inside && image_.at<std::uint8_t>(nearest) == kFree;
}

void FeatureMask::occupy_circle(const cv::Point2f& pixel, int radius_px) {
  if (radius_px <= 0) return;
  cv::circle(image_, cv::Point(cvRound(pixel.x), cvRound(pixel.y)), radius_px, kOccupied, cv::FILLED);
}

bool FeatureMask::try_occupy(const cv::Point2f& pixel, int radius_px) {
  if (!is_free(pixel)) return false;
  occupy_circle(pixel, radius_px);
  return true;
}

std::unique_ptr<FeatureDetector> make_feature_detector(const FrontendConfig& config) {
  switch (config.detector) {
    case FeatureDetectorKind::kGridFast:
      return std::make_unique<GridDetector>(config.grid, config.max_features);
    case FeatureDetectorKind::kShiTomasi:
      return std::make_unique<ShiTomasiDetector>();
  }
  check_failed("a detector of this kind exists", __FILE__, __LINE__);
}

const std::vector<cv::Point2f>& ShiTomasiDetector::detect(const DetectionRequest& request) {
  corners_.clear();
  if (request.wanted <= 0) return corners_;
  cv::goodFeaturesToTrack(request.gray, corners_, request.wanted, kQuality, request.min_distance_px,
                          request.mask.image());
  return corners_;
}

}  // namespace stillpoint
