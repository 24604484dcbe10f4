// SPDX-License-Identifier: BSD-3-Clause
#include "core/frontend/frame_check.h"

#include <string>

#include "core/base/error.h"

namespace stillpoint {
namespace {

std::string size_text(const cv::Size& size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

}  // namespace

void check_frame(const Frame& frame, const Camera& camera) {
  const std::string location = "frame " + std::to_string(frame.id);
  const cv::Size expected(camera.width, camera.height);
  if (frame.gray.type() != CV_8UC1 || frame.gray.size() != expected) {
    throw InputError(location, "gray image is " + size_text(frame.gray.size()) + " " +
                                   cv::typeToString(frame.gray.type()) + ", expected " + size_text(expected) +
                                   " CV_8UC1; check the calibration");
  }
  if (frame.depth.empty()) return;
  if (frame.depth.type() != CV_16UC1 || frame.depth.size() != expected) {
    throw InputError(location, "depth image is " + size_text(frame.depth.size()) + " " +
                                   cv::typeToString(frame.depth.type()) + ", expected " +
                                   size_text(expected) + " CV_16UC1; register it to the color image");
  }
}

}  // namespace stillpoint
