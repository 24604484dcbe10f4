// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/loop_metrics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "eval/metrics/ate.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::eval {
namespace {

constexpr double kMaxTrueStep_s = 0.05;
constexpr double kLeft = 2.0;  // a place is left at this multiple of its extent

/// True pose at `t`, interpolated between two poses that are at most twice `kMaxTrueStep_s` apart, or
/// that of the nearest one.
std::optional<Pose> true_pose(const Trajectory& gt, Timestamp t) {
  const auto later = std::ranges::lower_bound(gt.poses, t, {}, &StampedPose::t);
  if (later == gt.poses.end() || later == gt.poses.begin()) {
    if (gt.poses.empty()) return std::nullopt;
    const StampedPose& end = later == gt.poses.end() ? gt.poses.back() : gt.poses.front();
    if (std::abs(seconds_between(end.t, t)) > kMaxTrueStep_s) return std::nullopt;
    return end.T_w_f;
  }
  const StampedPose& before = *std::prev(later);
  const double interval_s = seconds_between(before.t, later->t);
  if (interval_s > 2.0 * kMaxTrueStep_s && later->t != t) return std::nullopt;
  return interpolate(before.T_w_f, later->T_w_f, seconds_between(before.t, t) / interval_s);
}

double angle_deg(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b) * 180.0 / std::numbers::pi;
}

bool is_within(const Pose& a, const Pose& b, double limit_m, double limit_deg) {
  return (a.p - b.p).norm() <= limit_m && angle_deg(a.q, b.q) <= limit_deg;
}

/// Whether keyframe `k` is at a place that the camera left since an earlier keyframe.
bool is_revisit(const std::vector<StampedPose>& keyframes, std::size_t k, const RevisitLimits& limits) {
  const Pose& here = keyframes[k].T_w_f;
  bool left = false;
  for (std::size_t i = k; i-- > 0;) {
    const Pose& there = keyframes[i].T_w_f;
    if (!is_within(here, there, kLeft * limits.place_m, kLeft * limits.place_deg)) left = true;
    if (left && is_within(here, there, limits.place_m, limits.place_deg)) return true;
  }
  return false;
}

}  // namespace

RevisitScore score_revisits(const Trajectory& gt, std::span<const Timestamp> keyframes,
                            std::span<const ReportedLoop> loops, const RevisitLimits& limits) {
  RevisitScore score;
  std::set<Timestamp> queries;  // of accepted true loops
  for (const ReportedLoop& loop : loops) {
    const std::optional<Pose> query = true_pose(gt, loop.query_t), match = true_pose(gt, loop.match_t);
    if (!query || !match) continue;
    const bool is_true =
        is_within(match->inverse() * *query, loop.T_match_query, limits.loop_m, limits.loop_deg);
    if (loop.accepted) ++(is_true ? score.true_loops : score.false_loops);
    if (!loop.accepted && is_true) ++score.missed_loops;
    if (loop.accepted && is_true) queries.insert(loop.query_t);
  }
  std::vector<StampedPose> poses;
  for (const Timestamp t : keyframes) {
    if (const std::optional<Pose> pose = true_pose(gt, t)) poses.push_back({t, *pose});
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (!is_revisit(poses, k, limits)) continue;
    ++score.revisits;
    score.recognized += queries.contains(poses[k].t) ? 1 : 0;
  }
  if (score.revisits > 0) {
    score.recall = static_cast<double>(score.recognized) / static_cast<double>(score.revisits);
  }
  return score;
}

namespace {

constexpr double kAligned_s = 10.0;
constexpr double kAfterLoop_s = 1.0;

std::vector<MatchedPose> matches_of(const Trajectory& gt, const Trajectory& est) {
  return matched_poses(gt, est, associate_tum(gt, est));
}

/// RMSE over the poses from `begin` on at times of `frames`; nullopt without such poses.
std::optional<double> rmse_m(std::vector<MatchedPose> matches, Timestamp begin, const Trajectory& frames,
                             const Similarity& S_w_v) {
  std::erase_if(matches, [&](const MatchedPose& match) {
    return match.t < begin || !std::ranges::binary_search(frames.poses, match.t, {}, &StampedPose::t);
  });
  if (matches.empty()) return std::nullopt;
  return statistics(ate_errors(matches, S_w_v).translation_m)->rmse;
}

}  // namespace

std::optional<ErrorAfterLoop> error_after_loop(const Trajectory& gt, const Trajectory& odometry,
                                               const Trajectory& causal, Timestamp first_loop) {
  const std::vector<MatchedPose> matches = matches_of(gt, odometry);
  if (matches.empty()) return std::nullopt;
  std::vector<MatchedPose> start = matches;
  const Timestamp end = std::min(first_loop, after(matches.front().t, kAligned_s));
  std::erase_if(start, [&](const MatchedPose& match) { return match.t >= end; });
  const AlignmentResult alignment = align(start, Alignment::kSe3);
  if (!alignment.determined) return std::nullopt;
  const Timestamp begin = after(first_loop, kAfterLoop_s);
  const std::optional<double> odometry_m = rmse_m(matches, begin, causal, alignment.S_w_v);
  const std::optional<double> causal_m = rmse_m(matches_of(gt, causal), begin, odometry, alignment.S_w_v);
  if (!odometry_m || !causal_m) return std::nullopt;
  ErrorAfterLoop error{.odometry_m = *odometry_m, .causal_m = *causal_m};
  if (*odometry_m > 0.0) error.ratio = *causal_m / *odometry_m;
  return error;
}

}  // namespace stillpoint::eval
