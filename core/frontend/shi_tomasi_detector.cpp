// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/shi_tomasi_detector.h"

#include <opencv2/imgproc.hpp>

namespace stillpoint {

std::vector<cv::Point2f> ShiTomasiDetector::detect(const DetectionRequest& request) {
  std::vector<cv::Point2f> corners;
  if (request.wanted <= 0) return corners;
  cv::goodFeaturesToTrack(request.gray, corners, request.wanted, quality_, request.min_distance_px,
                          request.mask.image());
  return corners;
}

}  // namespace stillpoint
