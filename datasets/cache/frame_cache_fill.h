// SPDX-License-Identifier: BSD-3-Clause
/// Writes the frame cache of a sequence while the sequence is rendered, so that its first run decodes
/// nothing.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>

#include "core/types/frame.h"
#include "datasets/cache/cache_space.h"
#include "datasets/cache/frame_cache_options.h"
#include "datasets/cache/frame_file.h"
#include "datasets/formats/sequence_content.h"

namespace stillpoint::datasets {

/// Problems end the writing with a warning; the first run decodes the images then.
class FrameCacheFill {
 public:
  /// @param sequence name for listings; renderings with the same name are not written at the same time
  FrameCacheFill(FrameCacheOptions options, std::string sequence);

  /// Adds the images as the decoder will return them. Thread-safe, in any order of frames.
  /// @param color CV_8UC3 (R, G, B)
  /// @param depth CV_16UC1, registered
  void add(std::size_t index, const cv::Mat& color, const cv::Mat& depth);

  /// Whether frames were added and written.
  [[nodiscard]] bool has_frames() const;

  /// Completes the file with the digests of the image files, which are read but not decoded.
  /// @param content the sequence as it was read back
  void finish(const SequenceContent& content);

 private:
  void write(std::size_t index, cv::Size size, const PackedFrame& frame);
  void stop(const std::string& reason);

  FrameCacheOptions options_;
  std::string sequence_;
  CacheSpace space_;
  mutable std::mutex mutex_;
  std::unique_ptr<FrameFileWriter> writer_;
  bool stopped_ = false;
};

}  // namespace stillpoint::datasets
