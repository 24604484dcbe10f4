// SPDX-License-Identifier: BSD-3-Clause
/// Encodes images to an .mp4 file. The only files that use OpenCV's video encoders.
#pragma once

#include <filesystem>
#include <memory>

#include <opencv2/core/mat.hpp>

namespace stillpoint::report {

/// H.264 if OpenCV has an encoder for it, else MPEG-4. The file is complete only after `finish`.
class VideoFile {
 public:
  /// @param size    of the images, both sides >= 2; an odd last row or column is cropped, as H.264 requires
  /// @param rate_hz > 0
  /// @throws InputError if the file cannot be written or no encoder is available
  VideoFile(std::filesystem::path file, cv::Size size, double rate_hz);
  VideoFile(VideoFile&&) noexcept;
  VideoFile& operator=(VideoFile&&) noexcept;
  ~VideoFile();

  /// @param image CV_8UC3 RGB, of the size given to the constructor
  void add(const cv::Mat& image);

  /// Finalizes the file. @throws InputError if the disk is full
  void finish();

 private:
  struct Encoder;  // hides opencv2/videoio.hpp
  std::filesystem::path file_;
  cv::Size size_;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace stillpoint::report
