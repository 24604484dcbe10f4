// SPDX-License-Identifier: BSD-3-Clause
/// Source of libstillpoint_video.so. It is linked with no other source of the project.
#include "reports/frames/video_module.h"

#include <memory>

#include <opencv2/videoio.hpp>

namespace stillpoint::report {
namespace {

VideoSink open(const std::filesystem::path& file, cv::Size size, double rate_hz) {
  const auto writer = std::make_shared<cv::VideoWriter>();
  const int h264 = cv::VideoWriter::fourcc('a', 'v', 'c', '1');
  const int mpeg4 = cv::VideoWriter::fourcc('m', 'p', '4', 'v');
  for (const int codec : {h264, mpeg4}) {
    if (writer->open(file.string(), cv::CAP_FFMPEG, codec, rate_hz, size))
      return [writer](const cv::Mat& image) { writer->write(image); };
  }
  return {};
}

}  // namespace

extern "C" const VideoModule stillpoint_video_module;
const VideoModule stillpoint_video_module = {.open = open};

}  // namespace stillpoint::report
