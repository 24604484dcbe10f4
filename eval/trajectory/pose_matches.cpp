// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/pose_matches.h"

#include <algorithm>
#include <utility>

namespace stillpoint::eval {
namespace {

std::vector<MatchedPose> copied(const PoseMatches& matches) {
  std::vector<MatchedPose> poses;
  poses.reserve(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) poses.push_back(matches[i]);
  return poses;
}

}  // namespace

PoseMatches::PoseMatches(const Trajectory& gt, const Trajectory& est, std::vector<IndexPair> pairs)
    : gt_(gt.poses), est_(est.poses), pairs_(std::move(pairs)) {}

PoseMatches::PoseMatches(const Trajectory& gt, const Trajectory& est, std::vector<InterpolatedPair> pairs)
    : gt_(gt.poses), est_(est.poses), interpolated_(std::move(pairs)) {
  if (std::ranges::none_of(interpolated_, is_between)) return;
  q_gt_.reserve(interpolated_.size());
  for (const InterpolatedPair& pair : interpolated_) {
    const Eigen::Quaterniond& from = gt_[pair.gt].T_w_f.q;
    q_gt_.push_back(is_between(pair) ? from.slerp(pair.fraction, gt_[pair.gt + 1].T_w_f.q) : from);
  }
}

std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                       std::span<const IndexPair> pairs) {
  return copied({gt, est, std::vector<IndexPair>(pairs.begin(), pairs.end())});
}

std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                       std::span<const InterpolatedPair> pairs) {
  return copied({gt, est, std::vector<InterpolatedPair>(pairs.begin(), pairs.end())});
}

}  // namespace stillpoint::eval
