// SPDX-License-Identifier: BSD-3-Clause
/// Interface of what finds new points to follow. Paper Sec. III-B.
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

#include "core/frontend/feature_mask.h"
#include "core/frontend/frontend_config.h"

namespace stillpoint {

/// What one detection is asked.
struct DetectionRequest {
  const cv::Mat& gray;                   ///< CV_8UC1
  const FeatureMask& mask;               ///< of the size of gray; new points lie on free pixels
  std::span<const cv::Point2f> tracked;  ///< features that are there already
  int wanted = 0;                        ///< most points to return
  int min_distance_px = 0;               ///< between two new points; 0 = any
};

/// One of the plug-in points of the house. May remember earlier pictures.
class FeatureDetector {
 public:
  virtual ~FeatureDetector() = default;

  /// New points, the most wanted first [px]. Same history and same request, same answer.
  /// @return valid until the next call
  [[nodiscard]] virtual const std::vector<cv::Point2f>& detect(const DetectionRequest& request) = 0;

  /// Forgets what earlier pictures taught.
  virtual void reset() = 0;
};

/// The detector that the config names.
[[nodiscard]] std::unique_ptr<FeatureDetector> make_feature_detector(const FrontendConfig& config);

}  // namespace stillpoint
