// SPDX-License-Identifier: BSD-3-Clause
/// Interface of feature detectors. Paper Sec. III-B.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "core/config/frontend_config.h"
#include "core/frontend/detect/feature_mask.h"

namespace stillpoint {

/// Input of one detection.
struct DetectionRequest {
  const cv::Mat& gray;                   ///< CV_8UC1
  const FeatureMask& mask;               ///< same size as gray; new features lie on free pixels
  std::span<const cv::Point2f> tracked;  ///< existing features
  int wanted = 0;                        ///< maximum number of features to return
  int min_distance_px = 0;               ///< between two new features; 0 = any
};

/// Extension point for detectors. Implementations may keep state between frames.
class FeatureDetector {
 public:
  virtual ~FeatureDetector() = default;

  /// New features [px], by descending priority. Deterministic for the same sequence of requests.
  /// @return valid until the next call
  [[nodiscard]] virtual const std::vector<cv::Point2f>& detect(const DetectionRequest& request) = 0;

  /// Resets the state kept between frames.
  virtual void reset() = 0;
};

/// Creates the detector selected by the config.
[[nodiscard]] std::unique_ptr<FeatureDetector> make_feature_detector(const FrontendConfig& config);

}  // namespace stillpoint
