// SPDX-License-Identifier: BSD-3-Clause
/// Encodes images to an .mp4 file.
#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

#include "reports/frames/video_module.h"

namespace stillpoint::report {

/// H.264 if OpenCV has an encoder for it, else MPEG-4. The file is complete only after `finish`.
class VideoFile {
 public:
  /// @param size    of the images, both sides >= 2; an odd last row or column is cropped, as H.264 requires
  /// @param rate_hz > 0
  /// @throws InputError if the file cannot be written or no encoder is installed
  VideoFile(std::filesystem::path file, cv::Size size, double rate_hz);

  /// @param image CV_8UC3 RGB, of the size given to the constructor
  void add(const cv::Mat& image);

  /// Finalizes the file. @throws InputError if the disk is full
  void finish();

 private:
  std::filesystem::path file_;
  cv::Size size_;
  VideoSink encoder_;
};

}  // namespace stillpoint::report
