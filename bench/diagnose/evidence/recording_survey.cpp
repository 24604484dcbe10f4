// SPDX-License-Identifier: BSD-3-Clause
#include "bench/diagnose/evidence/recording_survey.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/base/error.h"
#include "core/geometry/so3.h"
#include "datasets/image_motion.h"

namespace stillpoint::bench {
namespace {

constexpr int kRowStep_px = 4;       ///< every 4th row and column counts for the statistics
constexpr double kMinLocated = 0.6;  ///< fraction of the frames with a pose

bool equal(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty() || a.size() != b.size() || a.type() != b.type()) return false;
  for (int row = 0; row < a.rows; ++row) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols) * a.elemSize()) != 0)
      return false;
  }
  return true;
}

/// Mean square of the Laplacian.
double squared_laplacian(const cv::Mat& gray) {
  double squares = 0.0, count = 0.0;
  for (int y = kRowStep_px; y + 1 < gray.rows; y += kRowStep_px) {
    const std::uint8_t *const above = gray.ptr(y - 1), *const row = gray.ptr(y),
                              *const below = gray.ptr(y + 1);
    for (int x = 1; x + 1 < gray.cols; ++x) {
      const double laplacian = row[x - 1] + row[x + 1] + above[x] + below[x] - 4 * row[x];
      squares += laplacian * laplacian;
      count += 1.0;
    }
  }
  return count > 0.0 ? squares / count : 0.0;
}

void add_gray(const cv::Mat& gray, FrameStatistics& frame) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (int y = 0; y < gray.rows; y += kRowStep_px) {
    for (int x = 0; x < gray.cols; x += kRowStep_px) {
      const double value = gray.at<std::uint8_t>(y, x);
      sum += value;
      squares += value * value;
      count += 1.0;
      frame.dark_ratio += value < 5.0 ? 1.0 : 0.0;
      frame.bright_ratio += value > 250.0 ? 1.0 : 0.0;
    }
  }
  frame.mean_gray = sum / count;
  frame.deviation_gray = std::sqrt(std::max(0.0, squares / count - frame.mean_gray * frame.mean_gray));
  frame.dark_ratio /= count;
  frame.bright_ratio /= count;
  frame.sharpness = std::sqrt(squared_laplacian(gray)) / std::max(1.0, frame.deviation_gray);
}

void add_depth(const cv::Mat& depth, FrameStatistics& frame) {
  for (int y = 0; y < depth.rows; y += kSurveyStep_px) {
    for (int x = 0; x < depth.cols; x += kSurveyStep_px) {
      frame.depth.push_back(depth.at<std::uint16_t>(y, x));
      frame.depth_ratio += frame.depth.back() > 0 ? 1.0 : 0.0;
    }
  }
  if (!frame.depth.empty()) frame.depth_ratio /= static_cast<double>(frame.depth.size());
}

/// T_now_last of two frames; nullopt if one has no pose, or both are the same.
std::optional<Pose> motion_between(const Trajectory& trajectory, Timestamp last, Timestamp now) {
  const auto at = [&](Timestamp t) {
    return std::ranges::lower_bound(trajectory.poses, t, {}, &StampedPose::t);
  };
  const auto from = at(last), to = at(now);
  if (from == to || to == trajectory.poses.end() || from->t != last || to->t != now) return std::nullopt;
  return to->T_w_f.inverse() * from->T_w_f;
}

}  // namespace

std::vector<datasets::RateInterval> RecordingSurvey::rates() const {
  std::vector<datasets::RateInterval> rates;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    if (!frames[i].T_now_last || frames[i].same_image) continue;
    const Timestamp from = frames[i - 1].t, to = frames[i].t;
    const double interval_s = seconds_between(from, to);
    rates.push_back({from, to, -log_so3(frames[i].T_now_last->q) / interval_s});
  }
  return rates;
}

void require_depth_or_imu(const datasets::SensorStream& stream) {
  const datasets::SequenceInfo& info = stream.info();
  if (!info.imu.empty() || info.frame_times.empty() || !stream.load_frame(0).depth.empty()) return;
  throw InputError(
      info.folder.string(),
      "has neither depth images nor inertial data, one of which the odometry requires; record them, "
      "or name the topics of a bag (--topics depth=TOPIC)");
}

RecordingSurvey survey_recording(const datasets::SensorStream& stream, const Trajectory& visual,
                                 const std::function<bool()>& stop_requested) {
  RecordingSurvey survey;
  std::optional<datasets::ImageMotion> alignment;
  const std::vector<Timestamp>& times = stream.info().frame_times;
  if (static_cast<double>(visual.poses.size()) < kMinLocated * static_cast<double>(times.size()))
    alignment.emplace(stream.info().rig.camera);
  datasets::ImagePlausibility plausibility(stream.info());
  Frame last;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (stop_requested && stop_requested()) break;
    Frame frame;
    try {
      frame = stream.load_frame(i);
    } catch (const InputError&) {
      ++survey.unreadable;
      continue;
    }
    FrameStatistics statistics{.t = frame.t};
    add_gray(frame.gray, statistics);
    add_depth(frame.depth, statistics);
    plausibility.compare_depth(frame);
    statistics.same_image = equal(frame.gray, last.gray);
    statistics.same_depth = equal(frame.depth, last.depth);
    statistics.T_now_last =
        alignment ? alignment->add(frame) : motion_between(visual, i > 0 ? times[i - 1] : frame.t, frame.t);
    survey.frames.push_back(std::move(statistics));
    last = std::move(frame);
  }
  survey.depth_scale = plausibility.depth_scale_by_truth();
  return survey;
}

}  // namespace stillpoint::bench
