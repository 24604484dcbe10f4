// SPDX-License-Identifier: BSD-3-Clause
/// Feature detectors: their interface, the masks that exclude image regions (Paper Sec. III-A, III-B), and
/// the detector of the baselines, Shi-Tomasi. The detector of the paper is in grid_detector.h.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/config/frontend_config.h"

namespace stillpoint {

/// Circular masks that exclude image regions from detection: marks each pixel as free or occupied. The
/// tracker occupies a circle around each stable feature (orange in Fig. 2 of the paper), against clustered
/// features, and around each unstable feature, i.e. one lost since the last detection (purple), against
/// redetection in blurred or weakly textured regions.
class FeatureMask {
 public:
  /// Resizes the mask and marks all pixels as free.
  void clear(cv::Size size);

  /// Whether the pixel (rounded) lies inside the image and outside all circles.
  [[nodiscard]] bool is_free(const cv::Point2f& pixel) const;

  /// Occupies the disc around the pixel (rounded); no effect for a radius of 0 or less.
  void occupy_circle(const cv::Point2f& pixel, int radius_px);

  /// Occupies the circle if its center is free. Called from the oldest feature to the newest, it keeps the
  /// older of two features that are too close.
  /// @return whether the center was free
  bool try_occupy(const cv::Point2f& pixel, int radius_px);

  /// CV_8UC1, 255 = free, 0 = occupied.
  [[nodiscard]] const cv::Mat& image() const { return image_; }

 private:
  cv::Mat image_;
};

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

/// Shi-Tomasi corners (minimum eigenvalue, 1994) over the whole image: the detector of VINS-Mono and
/// VINS-RGBD, the baseline of the paper's Table III.
class ShiTomasiDetector final : public FeatureDetector {
 public:
  [[nodiscard]] const std::vector<cv::Point2f>& detect(const DetectionRequest& request) override;
  void reset() override {}

 private:
  std::vector<cv::Point2f> corners_;
};

}  // namespace stillpoint
