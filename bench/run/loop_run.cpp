// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/loop_run.h"

#include <algorithm>

#include "eval/metrics/error_after_loop.h"
#include "eval/metrics/statistics.h"
#include "eval/score.h"

namespace stillpoint::bench {
namespace {

/// Correction of the output at a time.
struct Correction {
  Timestamp t;
  Pose T_m_w;
};

/// Of the located keyframes of a segment. The output at the time of a keyframe was not yet that of its final
/// pose by the odometry, which the window refined afterwards: the difference is corrected, too.
std::vector<Correction> corrections_of(const Trajectory& odometry, const LoopReport& report, int segment) {
  std::vector<Correction> corrections;
  for (const MapKeyframe& keyframe : report.keyframes) {
    if (keyframe.segment != segment || (segment > 0 && !keyframe.is_located)) continue;
    corrections.push_back({keyframe.t, keyframe.T_m_b * keyframe.T_w_b.inverse()});
    const auto output = std::ranges::lower_bound(odometry.poses, keyframe.t, {}, &StampedPose::t);
    const bool has_output = output != odometry.poses.end() && output->t == keyframe.t;
    if (has_output) corrections.back().T_m_w = keyframe.T_m_b * keyframe.T_b_c * output->T_w_f.inverse();
  }
  return corrections;
}

Pose corrected(const StampedPose& pose, std::span<const Correction> corrections) {
  const auto next = std::ranges::upper_bound(corrections, pose.t, {}, &Correction::t);
  const auto before = next == corrections.begin() ? next : next - 1;
  const Pose by_before = before->T_m_w * pose.T_w_f;
  if (next == corrections.end() || next == before) return by_before;
  const double s = seconds_between(before->t, pose.t) / seconds_between(before->t, next->t);
  return interpolate(by_before, next->T_m_w * pose.T_w_f, s);
}

eval::RevisitScore revisits_of(const Trajectory& gt, const LoopReport& report) {
  std::vector<Timestamp> keyframes;
  for (const MapKeyframe& keyframe : report.keyframes) keyframes.push_back(keyframe.t);
  std::vector<eval::ReportedLoop> loops;
  for (const LoopRecord& loop : report.loops) {
    if (loop.in_map) continue;  // its true pose is that of another run
    loops.push_back({loop.query_t, loop.match_t, loop.T_match_query, loop.outcome == LoopOutcome::kAccepted});
  }
  return eval::score_revisits(gt, keyframes, loops);
}

/// ATE of the poses from `begin` on [m].
std::optional<double> ate_m(const Trajectory& gt, Trajectory trajectory,
                            Timestamp begin = Timestamp{INT64_MIN}) {
  std::erase_if(trajectory.poses, [&](const StampedPose& pose) { return pose.t < begin; });
  if (gt.poses.empty() || trajectory.poses.empty()) return std::nullopt;
  const eval::Score score = eval::score(gt, trajectory, {});
  return score.ate ? std::optional<double>(score.ate->translation_m.rmse) : std::nullopt;
}

/// Nothing without an accepted loop, or with a loaded map, whose world differs from that of the odometry.
std::optional<eval::ErrorAfterLoop> error_after_first_loop(const Trajectory& gt, const Trajectory& odometry,
                                                           const LoopRun& run) {
  if (run.has_map) return std::nullopt;
  const auto first =
      std::ranges::find(run.report.loops, LoopOutcome::kAccepted, &LoopRecord::outcome);  // by query
  if (first == run.report.loops.end()) return std::nullopt;
  return eval::error_after_loop(gt, odometry, run.causal, first->query_t);
}

}  // namespace

Trajectory optimized_trajectory(std::span<const Trajectory> odometry, const LoopReport& report) {
  Trajectory result;
  for (std::size_t segment = 0; segment < odometry.size(); ++segment) {
    const Trajectory& part = odometry[segment];
    result.frame = part.frame;
    const std::vector<Correction> corrections = corrections_of(part, report, static_cast<int>(segment));
    if (corrections.empty() && segment > 0) continue;
    for (const StampedPose& pose : part.poses)
      result.poses.push_back({pose.t, corrections.empty() ? pose.T_w_f : corrected(pose, corrections)});
  }
  return result;
}

LoopScore score_loops(const Trajectory& gt, const Trajectory& odometry, const LoopRun& run) {
  LoopScore score;
  score.optimized_ate_m = ate_m(gt, run.optimized);
  score.causal_ate_m = ate_m(gt, run.causal);
  score.after_first = error_after_first_loop(gt, odometry, run);
  if (run.has_map && !run.causal.poses.empty()) {
    score.relocalization_s = seconds_between(run.optimized.poses.front().t, run.causal.poses.front().t);
  }
  score.keyframes = run.report.keyframes.size();
  score.candidates = run.report.loops.size();
  score.loops = static_cast<std::size_t>(
      std::ranges::count(run.report.loops, LoopOutcome::kAccepted, &LoopRecord::outcome));
  std::vector<double> times_ms;
  for (const MapKeyframe& keyframe : run.report.keyframes) times_ms.push_back(keyframe.cost.processing_ms);
  score.median_ms = eval::percentile(times_ms, 0.5);
  if (!gt.poses.empty()) score.revisits = revisits_of(gt, run.report);
  return score;
}

}  // namespace stillpoint::bench
