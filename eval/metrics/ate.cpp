// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/ate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.h"

namespace stillpoint::eval {

double rotation_angle(const Eigen::Quaterniond& q) {
  return 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
}

AteErrors ate_errors(MatchView matches, const Similarity& S_w_v) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  AteErrors errors;
  errors.translation_m.reserve(matches.size());
  errors.rotation_deg.reserve(matches.size());
  for (const MatchedPose& match : matches) {
    const Pose aligned = S_w_v * match.est;
    errors.translation_m.push_back((aligned.p - match.gt.p).norm());
    errors.rotation_deg.push_back(kDegrees * rotation_angle(aligned.q.conjugate() * match.gt.q));
  }
  return errors;
}

double position_rmse(MatchView matches, const Similarity& S_w_v) {
  double sse = 0.0;
  for (const MatchedPose& match : matches) {
    const double error_m = (S_w_v * match.est.p - match.gt.p).norm();
    sse += error_m * error_m;
  }
  return std::sqrt(sse / static_cast<double>(matches.size()));
}

AteErrors ate_errors(MatchView matches, const Similarity& S_w_v, const CompletedAlignment& completed) {
  AteErrors errors = ate_errors(matches, S_w_v);
  if (completed.source != RotationSource::kPositions)
    errors.rotation_deg = ate_errors(matches, completed.S_w_v).rotation_deg;
  return errors;
}

std::optional<AteResult> ate(const Trajectory& gt, const Trajectory& est, const AssociationOptions& options) {
  const PoseMatches matches(gt, est, associate_tum(gt, est, options));
  if (matches.size() < 2) return std::nullopt;
  const AlignmentResult alignment = align(matches, Alignment::kSe3);
  const AteErrors errors = ate_errors(matches, alignment.S_w_v, complete_rotation(matches, alignment.S_w_v));
  return AteResult{.translation_m = *statistics(errors.translation_m),
                   .rotation_deg = *statistics(errors.rotation_deg),
                   .alignment = alignment,
                   .pairs = matches.size()};
}

namespace {

/// Median interval of increasing stamps [s]; 0 for fewer than two.
double median_interval_s(std::span<const Timestamp> stamps) {
  std::vector<double> intervals;
  intervals.reserve(stamps.size());
  for (std::size_t i = 1; i < stamps.size(); ++i)
    intervals.push_back(seconds_between(stamps[i - 1], stamps[i]));
  return percentile(intervals, 0.5).value_or(0.0);
}

}  // namespace

std::optional<double> coverage(const Trajectory& est, std::span<const Timestamp> expected,
                               double tolerance_s) {
  if (expected.empty()) return std::nullopt;
  const double max_difference_s = std::max(tolerance_s, 0.5 * median_interval_s(expected));
  std::size_t covered = 0;
  std::size_t e = 0;
  for (const Timestamp t : expected) {
    while (e < est.poses.size() && seconds_between(est.poses[e].t, t) > max_difference_s) ++e;
    if (e == est.poses.size()) break;
    if (seconds_between(t, est.poses[e].t) > max_difference_s) continue;
    ++covered;
    ++e;
  }
  return static_cast<double>(covered) / static_cast<double>(expected.size());
}

std::optional<double> first_pose_seconds(const Trajectory& est, Timestamp start) {
  if (est.poses.empty()) return std::nullopt;
  return std::max(0.0, seconds_between(start, est.poses.front().t));
}

std::vector<TimeSpan> lost_spans(const Trajectory& est, const TimeSpan& whole, double max_hold_s) {
  std::vector<TimeSpan> lost;
  Timestamp covered_until = whole.begin;
  for (const StampedPose& pose : est.poses) {
    if (pose.t >= whole.end) break;
    if (pose.t > covered_until) lost.push_back({covered_until, pose.t});
    covered_until = std::max(covered_until, after(pose.t, max_hold_s));
  }
  if (covered_until < whole.end) lost.push_back({covered_until, whole.end});
  return lost;
}

std::optional<double> time_coverage(std::span<const TimeSpan> lost, const TimeSpan& whole) {
  const double duration_s = seconds_between(whole.begin, whole.end);
  if (duration_s <= 0.0) return std::nullopt;
  __int128 lost_ns = 0;  // rounded seconds may add up to more than the duration
  for (const TimeSpan& span : lost) lost_ns += static_cast<__int128>(span.end.ns) - span.begin.ns;
  return 1.0 - static_cast<double>(lost_ns) * 1e-9 / duration_s;
}

double correct_seconds(MatchView matches, const AteErrors& errors, Timestamp end,
                       const CorrectRateOptions& options) {
  STILLPOINT_CHECK(errors.translation_m.size() == matches.size() &&
                   errors.rotation_deg.size() == matches.size());
  constexpr double kLongestHold_s = 9e9;  // fits in 64 bits as nanoseconds
  const __int128 max_hold_ns = from_seconds(std::min(options.max_hold_s, kLongestHold_s)).ns;
  __int128 correct_ns = 0;  // rounded seconds may add up to more than the duration
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const bool correct = errors.translation_m[i] <= options.max_translation_m &&
                         errors.rotation_deg[i] <= options.max_rotation_deg;
    const Timestamp until = i + 1 < matches.size() ? matches.time(i + 1) : end;
    const __int128 until_next_ns = static_cast<__int128>(until.ns) - matches.time(i).ns;
    if (correct) correct_ns += std::clamp<__int128>(until_next_ns, 0, max_hold_ns);
  }
  return static_cast<double>(correct_ns) * 1e-9;
}

namespace {

/// Whether two poses lie between the first and the last of the ground truth.
bool is_covered(const Trajectory& gt, const Trajectory& est, double offset_s) {
  return std::ranges::count_if(est.poses, [&](const StampedPose& pose) {
           const Timestamp t = after(pose.t, offset_s);
           return gt.poses.front().t <= t && t <= gt.poses.back().t;
         }) >= 2;
}

}  // namespace

std::optional<double> correct_rate(const Trajectory& gt, const Trajectory& est,
                                   const CorrectRateOptions& options, double offset_s) {
  if (gt.poses.size() < 2) return std::nullopt;
  PoseMatches matches(gt, est, associate_interpolated(gt, est, kCorrectRateGap_s, offset_s));
  if (matches.size() < 2) return is_covered(gt, est, offset_s) ? std::nullopt : std::optional(0.0);
  matches.shift(offset_s);
  const Similarity S_w_v = align(matches, Alignment::kSe3).S_w_v;
  const CompletedAlignment completed = complete_rotation(matches, S_w_v);
  if (!completed.determined && std::isfinite(options.max_rotation_deg)) return std::nullopt;
  return correct_rate(matches, ate_errors(matches, S_w_v, completed), gt, options);
}

double correct_rate(MatchView matches, const AteErrors& errors, const Trajectory& gt,
                    const CorrectRateOptions& options) {
  const double correct = correct_seconds(matches, errors, gt.poses.back().t, options);
  return correct / seconds_between(gt.poses.front().t, gt.poses.back().t);
}

}  // namespace stillpoint::eval
