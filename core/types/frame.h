// SPDX-License-Identifier: BSD-3-Clause
/// One frame of an RGB-D camera, and when it arrives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include <opencv2/core/mat.hpp>

#include "core/base/timestamp.h"

namespace stillpoint {

/// Copies share their pixels; images are not modified after they were read.
struct Frame {
  std::int64_t id = 0;  ///< position in the sequence, from 0
  Timestamp t;          ///< timestamp of the color image
  cv::Mat gray;         ///< CV_8UC1
  cv::Mat color;        ///< CV_8UC3, RGB; may be empty, see `color_image`
  cv::Mat depth;        ///< CV_16UC1, same size as gray, registered to it; 0 = not measured; may be empty
  double depth_units_per_m = 1000.0;
  /// Decodes the color image where a reader deferred it; may be empty. Thread-safe; valid as long as the
  /// reader.
  std::function<cv::Mat()> decode_color;
};

/// The color image (CV_8UC3, RGB); decoded now if that was deferred. Empty for a gray camera.
/// @throws InputError if it is decoded now and cannot be read
[[nodiscard]] inline cv::Mat color_image(const Frame& frame) {
  return frame.color.empty() && frame.decode_color ? frame.decode_color() : frame.color;
}

/// Depth at a pixel (rounded to the nearest) [m]; 0 if not measured or outside the image.
[[nodiscard]] inline double depth_at(const cv::Mat& depth, double depth_units_per_m, double u_px,
                                     double v_px) {
  const int column = cvRound(u_px);
  const int row = cvRound(v_px);
  if (column < 0 || row < 0 || column >= depth.cols || row >= depth.rows) return 0.0;
  return depth.at<std::uint16_t>(row, column) / depth_units_per_m;
}

/// When a frame reaches the odometry: later than its exposure, in another order, or twice.
struct FrameArrival {
  std::size_t index = 0;  ///< position of the frame in the sequence
  Timestamp t;            ///< not earlier than the timestamp of the frame
};

}  // namespace stillpoint
