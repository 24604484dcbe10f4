// SPDX-License-Identifier: BSD-3-Clause
#include "reports/frames/worst_frames.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "datasets/io/image_io.h"
#include "eval/metrics/strict_rpe.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::report {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxWidth_px = 400;
constexpr int kJpegQuality = 70;  // text and thin circles stay legible

void prepare_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) throw InputError(folder.string(), "cannot be created (" + problem.message() + ")");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") fs::remove(entry.path());
  }
}

std::vector<std::optional<Pose>> ground_truth_of(const datasets::SequenceInfo& info) {
  const Trajectory truth =
      eval::move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera");
  Trajectory frames;
  for (const Timestamp t : info.frame_times) frames.poses.push_back({t, {}});
  std::vector<std::optional<Pose>> poses(info.frame_times.size());
  std::size_t frame = 0;
  for (const eval::MatchedPose& match : eval::strict_matches(truth, frames)) {
    while (info.frame_times[frame] < match.t) ++frame;
    poses[frame] = match.gt;
  }
  return poses;
}

cv::Mat downscaled(const cv::Mat& image) {
  if (image.cols <= kMaxWidth_px) return image;
  cv::Mat result;
  cv::resize(image, result, {kMaxWidth_px, image.rows * kMaxWidth_px / image.cols}, 0.0, 0.0, cv::INTER_AREA);
  return result;
}

}  // namespace

WorstFrames::WorstFrames(fs::path folder, std::size_t capacity, AnnotationStyle style,
                         const datasets::SequenceInfo& info)
    : folder_(std::move(folder)), annotator_(style), worst_(capacity), truth_(ground_truth_of(info)) {
  prepare_folder(folder_);
}

void WorstFrames::add(const FrameReport& report) {
  const auto frame = static_cast<std::size_t>(report.update.frame_id);
  const eval::WorstFrames::Insertion insertion =
      worst_.insert(frame, frame_to_frame_.next(matched(report.update)));
  if (!insertion.inserted) return annotator_.update_tracks(report);
  datasets::write_jpeg(file_of(frame), downscaled(annotator_.annotate(report)), kJpegQuality);
  if (insertion.evicted) fs::remove(file_of(*insertion.evicted));
}

std::optional<eval::MatchedPose> WorstFrames::matched(const OdometryUpdate& update) const {
  const std::optional<Pose>& truth = truth_.at(static_cast<std::size_t>(update.frame_id));
  if (!truth || !is_located(update.status)) return std::nullopt;
  return eval::MatchedPose{.t = {}, .gt = *truth, .est = update.T_w_c};
}

fs::path WorstFrames::file_of(std::size_t frame) const { return folder_ / fmt::format("{:06}.jpg", frame); }

AnnotationStyle annotation_style(const FrontendConfig& frontend) {
  return {.stable_radius_px = frontend.circular_mask ? frontend.min_distance_px : 0,
          .unstable_radius_px = frontend.circular_mask ? frontend.unstable_radius_px : 0};
}

}  // namespace stillpoint::report
