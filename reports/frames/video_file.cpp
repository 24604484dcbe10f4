// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/video_file.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/error.h"

namespace stillpoint::report {

struct VideoFile::Encoder {
  cv::VideoWriter writer;
};

namespace {

bool open(cv::VideoWriter& writer, const std::filesystem::path& file, cv::Size size, double rate_hz) {
  const int h264 = cv::VideoWriter::fourcc('a', 'v', 'c', '1');
  const int mpeg4 = cv::VideoWriter::fourcc('m', 'p', '4', 'v');
  for (const int codec : {h264, mpeg4}) {
    if (writer.open(file.string(), cv::CAP_FFMPEG, codec, rate_hz, size)) return true;
  }
  return false;
}

bool is_written(const std::filesystem::path& file) {
  std::error_code problem;
  const std::uintmax_t bytes = std::filesystem::file_size(file, problem);
  return !problem && bytes > 0;
}

}  // namespace

VideoFile::VideoFile(std::filesystem::path file, cv::Size size, double rate_hz)
    : file_(std::move(file)),
      size_(size.width / 2 * 2, size.height / 2 * 2),
      encoder_(std::make_unique<Encoder>()) {
  STILLPOINT_CHECK(!size_.empty() && rate_hz > 0.0);
  if (!open(encoder_->writer, file_, size_, rate_hz)) {
    throw InputError(
        file_.string(),
        "cannot be written as video; check that the folder is writable and OpenCV is built with FFmpeg");
  }
}

VideoFile::VideoFile(VideoFile&&) noexcept = default;
VideoFile& VideoFile::operator=(VideoFile&&) noexcept = default;
VideoFile::~VideoFile() = default;

void VideoFile::add(const cv::Mat& image) {
  STILLPOINT_CHECK(image.type() == CV_8UC3 && image.cols / 2 * 2 == size_.width &&
                   image.rows / 2 * 2 == size_.height);
  cv::Mat bgr;
  cv::cvtColor(image(cv::Rect(cv::Point(0, 0), size_)), bgr, cv::COLOR_RGB2BGR);
  encoder_->writer.write(bgr);
}

void VideoFile::finish() {
  encoder_->writer.release();
  if (!is_written(file_)) throw InputError(file_.string(), "is incomplete; is the disk full?");
}

}  // namespace stillpoint::report
