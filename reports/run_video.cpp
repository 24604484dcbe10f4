// SPDX-License-Identifier: BSD-3-Clause
#include "reports/run_video.h"

#include <fmt/format.h>

#include "core/base/error.h"
#include "datasets/image_io.h"

namespace stillpoint {
namespace {

constexpr double kUsualRate_hz = 30.0;

}  // namespace

RunVideo::RunVideo(std::filesystem::path folder, AnnotationStyle style, double rate_hz)
    : folder_(std::move(folder)), annotator_(style), rate_hz_(rate_hz) {
  std::error_code problem;
  std::filesystem::create_directories(folder_ / "frames", problem);
  if (problem) {
    throw InputError(folder_.string(),
                     "cannot be made (" + problem.message() + "); choose another --video folder");
  }
}

void RunVideo::add(const PictureReport& report) {
  const cv::Mat picture = annotator_.annotate(report);
  write_jpeg(folder_ / "frames" / fmt::format("{:06}.jpg", report.frame.id), picture);
  if (!video_) video_.emplace(folder_ / "video.mp4", picture.size(), rate_hz_);
  video_->add(picture);
}

void RunVideo::finish() {
  if (video_) video_->finish();
}

double mean_rate_hz(const std::vector<Timestamp>& times) {
  if (times.size() < 2) return kUsualRate_hz;
  return static_cast<double>(times.size() - 1) / seconds_between(times.front(), times.back());
}

}  // namespace stillpoint
