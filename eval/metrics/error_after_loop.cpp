// SPDX-License-Identifier: BSD-3-Clause
#include "eval/metrics/error_after_loop.h"

#include <algorithm>
#include <vector>

#include "eval/metrics/ate.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::eval {
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
