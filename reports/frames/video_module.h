// SPDX-License-Identifier: BSD-3-Clause
/// OpenCV's video encoders behind a function pointer, in a module of its own (datasets/io/shared_module.h).
#pragma once

#include <filesystem>
#include <functional>

#include <opencv2/core/mat.hpp>

namespace stillpoint::report {

/// Receives CV_8UC3 BGR images of one size. Its destruction completes the file.
using VideoSink = std::function<void(const cv::Mat&)>;

struct VideoModule {
  /// @param size both sides even
  /// @return an empty function if the file cannot be written or no encoder is available
  VideoSink (*open)(const std::filesystem::path& file, cv::Size size, double rate_hz);
};

}  // namespace stillpoint::report
