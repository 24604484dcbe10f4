// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/detect/shi_tomasi_detector.h"

#include <opencv2/imgproc.hpp>

namespace stillpoint {

const std::vector<cv::Point2f>& ShiTomasiDetector::detect(const DetectionRequest& request) {
  corners_.clear();
  if (request.wanted <= 0) return corners_;
  cv::goodFeaturesToTrack(request.gray, corners_, request.wanted, quality_, request.min_distance_px,
                          request.mask.image());
  return corners_;
}

}  // namespace stillpoint
