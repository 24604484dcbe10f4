// SPDX-License-Identifier: BSD-3-Clause
/// A black image for detectors that use only the time, id and size of a frame.
#pragma once

#include "core/types/frame.h"

namespace stillpoint {

inline constexpr int kBlankWidth = 640;
inline constexpr int kBlankHeight = 480;

/// Frame `id` at 30 Hz.
inline Frame blank_frame(std::int64_t id) {
  Frame frame;
  frame.id = id;
  frame.t = from_seconds(static_cast<double>(id) / 30.0);
  static const cv::Mat kBlack = cv::Mat::zeros(kBlankHeight, kBlankWidth, CV_8UC1);
  frame.gray = kBlack;  // shared: tests with thousands of frames need no other pixels
  return frame;
}

}  // namespace stillpoint
