// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/video_file.h"

#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "datasets/io/shared_module.h"

namespace stillpoint::report {

namespace {

VideoSink open(const std::filesystem::path& file, cv::Size size, double rate_hz) {
  const auto* const module =
      static_cast<const VideoModule*>(datasets::module_symbol("video", "stillpoint_video_module"));
  return module->open(file, size, rate_hz);
}

bool is_written(const std::filesystem::path& file) {
  std::error_code problem;
  const std::uintmax_t bytes = std::filesystem::file_size(file, problem);
  return !problem && bytes > 0;
}

}  // namespace

VideoFile::VideoFile(std::filesystem::path file, cv::Size size, double rate_hz)
    : file_(std::move(file)), size_(size.width / 2 * 2, size.height / 2 * 2) {
  STILLPOINT_CHECK(!size_.empty() && rate_hz > 0.0);
  encoder_ = open(file_, size_, rate_hz);
  if (!encoder_) {
    throw InputError(
        file_.string(),
        "cannot be written as video; check that the folder is writable and OpenCV is built with FFmpeg");
  }
}

void VideoFile::add(const cv::Mat& image) {
  STILLPOINT_CHECK(image.type() == CV_8UC3 && image.cols / 2 * 2 == size_.width &&
                   image.rows / 2 * 2 == size_.height);
  cv::Mat bgr;
  cv::cvtColor(image(cv::Rect(cv::Point(0, 0), size_)), bgr, cv::COLOR_RGB2BGR);
  encoder_(bgr);
}

void VideoFile::finish() {
  encoder_ = {};
  if (!is_written(file_)) throw InputError(file_.string(), "is incomplete; is the disk full?");
}

}  // namespace stillpoint::report
