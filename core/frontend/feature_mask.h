// SPDX-License-Identifier: BSD-3-Clause
/// Circles in which no new feature may be born: orange around stable ones, purple around lost ones.
/// Paper Sec. III-A.
#pragma once

#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// A picture's free and taken pixels.
class FeatureMask {
 public:
  /// Makes all pixels of a picture of this size free.
  void clear(cv::Size size);

  /// Whether the pixel (rounded) lies in the picture and in no circle.
  [[nodiscard]] bool is_free(const cv::Point2f& pixel) const;

  /// Takes the disc of this radius around the pixel (rounded); a radius of 0 or less takes nothing.
  void take_circle(const cv::Point2f& pixel, int radius_px);

  /// Takes the circle if its centre is free. Called from the oldest feature to the youngest, it keeps the
  /// older of two that have come too close.
  /// @return whether the centre was free
  bool claim(const cv::Point2f& pixel, int radius_px);

  /// CV_8UC1, 255 = free, 0 = taken.
  [[nodiscard]] const cv::Mat& image() const { return image_; }

 private:
  cv::Mat image_;
};

}  // namespace stillpoint
