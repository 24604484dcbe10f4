// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/run_result.h"

#include <algorithm>
#include <utility>

#include "eval/trajectory/frames.h"

namespace stillpoint::bench {
namespace {

/// Ground-truth trajectory of the camera over the given frames; uncropped if they are all of the sequence.
Trajectory camera_truth(const datasets::SequenceInfo& info, const std::vector<Timestamp>& frames) {
  Trajectory truth =
      eval::move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera");
  if (frames.size() == info.frame_times.size() || frames.empty()) return truth;
  // A frame may be associated with a slightly later or earlier ground-truth pose.
  const double margin_s = eval::ScoreOptions{}.max_difference_s;
  std::erase_if(truth.poses, [&](const StampedPose& pose) {
    return pose.t < after(frames.front(), -margin_s) || pose.t > after(frames.back(), margin_s);
  });
  return truth;
}

RunStatus status_of(const OdometryRun& run) {
  if (run.summary.interrupted) return RunStatus::kInterrupted;
  return run.trajectory.poses.empty() ? RunStatus::kFailed : RunStatus::kOk;
}

std::string failure_of(const OdometryRun& run) {
  switch (status_of(run)) {
    case RunStatus::kOk:
      return "";
    case RunStatus::kInterrupted:
      return "interrupted after " + std::to_string(run.summary.frames) + " of " +
             std::to_string(run.frames_planned) + " frames";
    case RunStatus::kFailed:
      return "no frame has a pose: the estimator never initialized";
  }
  return "";
}

}  // namespace

std::string status_name(RunStatus status) {
  switch (status) {
    case RunStatus::kOk:
      return "ok";
    case RunStatus::kInterrupted:
      return "interrupted";
    case RunStatus::kFailed:
      return "failed";
  }
  return "";
}

RunResult score_run(const datasets::SequenceInfo& info, OdometryRun run) {
  const std::size_t frames = std::min(run.summary.frames, info.frame_times.size());
  eval::ScoreOptions options;
  options.expected_times.assign(info.frame_times.begin(),
                                info.frame_times.begin() + static_cast<std::ptrdiff_t>(frames));
  RunResult result;
  result.sequence = info.name;
  result.status = status_of(run);
  result.failure = failure_of(run);
  result.notes = info.notes;
  result.score = eval::score(camera_truth(info, options.expected_times), run.trajectory, options);
  result.run = std::move(run);
  return result;
}

}  // namespace stillpoint::bench
