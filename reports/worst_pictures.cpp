// SPDX-License-Identifier: BSD-3-Clause
#include "reports/worst_pictures.h"

#include <algorithm>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/base/error.h"
#include "datasets/image_io.h"
#include "eval/metrics/strict_rpe.h"
#include "eval/trajectory/frames.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxWidth_px = 400;
constexpr int kQuality = 70;  // of the JPEG: text and thin circles stay legible

void make_empty(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) throw InputError(folder.string(), "cannot be made (" + problem.message() + ")");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".jpg") fs::remove(entry.path());
  }
}

std::vector<std::optional<Pose>> truth_of(const SequenceInfo& info) {
  const Trajectory truth =
      move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera");
  Trajectory asked;
  for (const Timestamp t : info.frame_times) asked.poses.push_back({t, {}});
  std::vector<std::optional<Pose>> poses(info.frame_times.size());
  std::size_t frame = 0;
  for (const MatchedPose& match : strict_matches(truth, asked)) {
    while (info.frame_times[frame] < match.t) ++frame;
    poses[frame] = match.gt;
  }
  return poses;
}

cv::Mat small(const cv::Mat& picture) {
  if (picture.cols <= kMaxWidth_px) return picture;
  cv::Mat result;
  cv::resize(picture, result, {kMaxWidth_px, picture.rows * kMaxWidth_px / picture.cols}, 0.0, 0.0,
             cv::INTER_AREA);
  return result;
}

}  // namespace

WorstPictures::WorstPictures(fs::path folder, std::size_t room, AnnotationStyle style,
                             const SequenceInfo& info)
    : folder_(std::move(folder)), annotator_(style), worst_(room), truth_(truth_of(info)) {
  make_empty(folder_);
}

void WorstPictures::add(const PictureReport& report) {
  const auto frame = static_cast<std::size_t>(report.update.frame_id);
  const WorstFrames::Answer answer = worst_.offer(frame, growth_.next(matched(report.update)));
  if (!answer.is_taken) return annotator_.follow(report);
  write_jpeg(file_of(frame), small(annotator_.annotate(report)), kQuality);
  if (answer.dropped) fs::remove(file_of(*answer.dropped));
}

std::optional<MatchedPose> WorstPictures::matched(const OdometryUpdate& update) const {
  const std::optional<Pose>& truth = truth_.at(static_cast<std::size_t>(update.frame_id));
  if (!truth || update.status != OdometryStatus::kTracking) return std::nullopt;
  return MatchedPose{.t = {}, .gt = *truth, .est = update.T_w_c};
}

fs::path WorstPictures::file_of(std::size_t frame) const { return folder_ / fmt::format("{:06}.jpg", frame); }

AnnotationStyle annotation_style(const FrontendConfig& frontend) {
  return {.stable_radius_px = frontend.circular_mask ? frontend.min_distance_px : 0,
          .unstable_radius_px = frontend.circular_mask ? frontend.unstable_radius_px : 0};
}

}  // namespace stillpoint
