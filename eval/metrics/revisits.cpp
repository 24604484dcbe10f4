// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/revisits.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

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

}  // namespace stillpoint::eval
