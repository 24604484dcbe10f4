// SPDX-License-Identifier: BSD-3-Clause
/// Corners by the smaller eigenvalue over the whole picture (Shi and Tomasi 1994): what VINS-Mono and
/// VINS-RGBD use, and the paper's Table III compares with.
#pragma once

#include "core/frontend/feature_detector.h"

namespace stillpoint {

class ShiTomasiDetector final : public FeatureDetector {
 public:
  /// @param quality least strength of a corner as a share of the picture's best, in (0, 1)
  explicit ShiTomasiDetector(double quality) : quality_(quality) {}

  [[nodiscard]] const std::vector<cv::Point2f>& detect(const DetectionRequest& request) override;
  void reset() override {}

 private:
  double quality_;
  std::vector<cv::Point2f> corners_;
};

}  // namespace stillpoint
