// SPDX-License-Identifier: BSD-3-Clause
/// Circular masks that exclude image regions from feature detection. Paper Sec. III-A.
#pragma once

#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// Marks each pixel as free or occupied. The tracker occupies a circle around each stable feature (orange in
/// Fig. 2 of the paper), against clustered features, and around each unstable feature, i.e. one lost since
/// the last detection (purple), against redetection in blurred or weakly textured regions.
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

}  // namespace stillpoint
