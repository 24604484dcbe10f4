// SPDX-License-Identifier: BSD-3-Clause
/// Pictures to an .mp4. The only file pair that knows OpenCV's encoders.
#pragma once

#include <filesystem>
#include <memory>

#include <opencv2/core/mat.hpp>

namespace stillpoint {

/// H.264 where OpenCV has an encoder for it, else MPEG-4. The file is whole only after `finish`.
class VideoFile {
 public:
  /// @param size of the pictures, both sides at least 2; an odd last row or column is left out, as H.264 must
  /// @param rate_hz > 0
  /// @throws InputError if the file cannot be written or nothing here encodes it
  VideoFile(std::filesystem::path file, cv::Size size, double rate_hz);
  VideoFile(VideoFile&&) noexcept;
  VideoFile& operator=(VideoFile&&) noexcept;
  ~VideoFile();

  /// @param picture CV_8UC3 in the order R, G, B, of the size given before
  void add(const cv::Mat& picture);

  /// Writes the end. @throws InputError if the disk is full
  void finish();

 private:
  struct Encoder;  // keeps OpenCV's header out of this one
  std::filesystem::path file_;
  cv::Size size_;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace stillpoint
