// SPDX-License-Identifier: BSD-3-Clause
/// Shi-Tomasi corners (minimum eigenvalue, 1994) over the whole image: the detector of VINS-Mono and
/// VINS-RGBD, the baseline of the paper's Table III.
#pragma once

#include "core/frontend/detect/feature_detector.h"

namespace stillpoint {

class ShiTomasiDetector final : public FeatureDetector {
 public:
  /// @param quality minimum corner strength relative to the strongest corner of the image, in (0, 1)
  explicit ShiTomasiDetector(double quality) : quality_(quality) {}

  [[nodiscard]] const std::vector<cv::Point2f>& detect(const DetectionRequest& request) override;
  void reset() override {}

 private:
  double quality_;
  std::vector<cv::Point2f> corners_;
};

}  // namespace stillpoint
