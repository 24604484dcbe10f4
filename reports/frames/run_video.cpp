// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/run_video.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/io/image_io.h"

namespace stillpoint::report {
namespace {

constexpr double kDefaultRate_hz = 30.0;

}  // namespace

RunVideo::RunVideo(std::filesystem::path folder, AnnotationStyle style, double rate_hz)
    : folder_(std::move(folder)), annotator_(style), rate_hz_(rate_hz) {
  std::error_code problem;
  std::filesystem::create_directories(folder_ / "frames", problem);
  if (problem) {
    throw InputError(folder_.string(),
                     "cannot be created (" + problem.message() + "); choose another --video folder");
  }
}

void RunVideo::add(const FrameReport& report) {
  const cv::Mat image = annotator_.annotate(report);
  datasets::write_jpeg(folder_ / "frames" / fmt::format("{:06}.jpg", report.frame.id), image);
  if (!video_) video_.emplace(folder_ / "video.mp4", image.size(), rate_hz_);
  video_->add(image);
}

void RunVideo::finish() {
  if (video_) video_->finish();
}

double mean_rate_hz(const std::vector<Timestamp>& times) {
  if (times.size() < 2) return kDefaultRate_hz;
  return static_cast<double>(times.size() - 1) / seconds_between(times.front(), times.back());
}

}  // namespace stillpoint::report
