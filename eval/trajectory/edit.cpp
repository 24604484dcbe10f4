// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trajectory/edit.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::eval {

CovariantTrajectory cropped(CovariantTrajectory path, Timestamp begin, Timestamp end) {
  const auto is_outside = [&](const auto& stamped) { return stamped.t < begin || end < stamped.t; };
  std::erase_if(path.trajectory.poses, is_outside);
  std::erase_if(path.covariances, is_outside);
  return path;
}

CovariantTrajectory merged(std::vector<CovariantTrajectory> parts, std::span<const std::string> names) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!parts[i].trajectory.poses.empty()) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return parts[i].trajectory.poses.front().t; });
  const bool have_covariances =
      std::ranges::none_of(order, [&](std::size_t i) { return parts[i].covariances.empty(); });
  CovariantTrajectory all;
  std::size_t previous = 0;
  for (const std::size_t i : order) {
    std::vector<StampedPose>& poses = all.trajectory.poses;
    const CovariantTrajectory& part = parts[i];
    if (poses.empty()) {
      all.trajectory.frame = part.trajectory.frame;
    } else if (!(poses.back().t < part.trajectory.poses.front().t)) {
      throw InputError(names[i], "overlaps in time with " + names[previous] + ", which ends at " +
                                     format_stamp(poses.back().t) + " s; crop one of them");
    }
    poses.insert(poses.end(), part.trajectory.poses.begin(), part.trajectory.poses.end());
    if (have_covariances)
      all.covariances.insert(all.covariances.end(), part.covariances.begin(), part.covariances.end());
    previous = i;
  }
  return all;
}

CovariantTrajectory in_world(CovariantTrajectory path, const Similarity& S_w_v) {
  const Eigen::Matrix3d R_w_v = S_w_v.T_w_v.R();
  for (StampedPose& pose : path.trajectory.poses) pose.T_w_f = S_w_v * pose.T_w_f;
  for (StampedCovariance& covariance : path.covariances) {
    const Eigen::Matrix3d position = R_w_v * covariance.position * R_w_v.transpose();
    covariance.position = S_w_v.scale * S_w_v.scale * position;
    covariance.rotation = (R_w_v * covariance.rotation * R_w_v.transpose()).eval();
  }
  return path;
}

Trajectory resampled(const Trajectory& path, std::span<const Timestamp> times, double max_gap_s) {
  Trajectory result{.frame = path.frame, .poses = {}};
  const std::vector<StampedPose>& poses = path.poses;
  for (const Timestamp t : times) {
    const auto after_or_at = std::ranges::lower_bound(poses, t, {}, &StampedPose::t);
    if (after_or_at == poses.end()) break;
    if (after_or_at->t == t) {
      result.poses.push_back(*after_or_at);
      continue;
    }
    if (after_or_at == poses.begin()) continue;
    const StampedPose& before = *std::prev(after_or_at);
    const double gap_s = seconds_between(before.t, after_or_at->t);
    if (gap_s > max_gap_s) continue;
    result.poses.emplace_back(
        t, interpolate(before.T_w_f, after_or_at->T_w_f, seconds_between(before.t, t) / gap_s));
  }
  return result;
}

}  // namespace stillpoint::eval
