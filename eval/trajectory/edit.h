// SPDX-License-Identifier: BSD-3-Clause
/// Changes of trajectories that keep the covariances of their poses: parts in time, joined parts, other
/// worlds and body frames, other rates.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/trajectory.h"
#include "eval/io/covariance_file.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

/// A trajectory, and a covariance of each pose, with the rotation about the axes of the world; none if empty.
struct CovariantTrajectory {
  Trajectory trajectory;
  std::vector<StampedCovariance> covariances = {};
};

/// The poses with stamps in [begin, end].
[[nodiscard]] CovariantTrajectory cropped(CovariantTrajectory path, Timestamp begin, Timestamp end);

/// The parts after each other in order of time. Covariances remain if every part has them.
/// @param parts in any order
/// @param names of the parts, for messages
/// @throws InputError if two parts overlap in time
[[nodiscard]] CovariantTrajectory merged(std::vector<CovariantTrajectory> parts,
                                         std::span<const std::string> names);

/// Poses in another world: T_w_f = S_w_v T_v_f. Covariances are rotated and scaled with it:
///   P_w = s^2 R P_v R^T (position),  P_w = R P_v R^T (rotation)
[[nodiscard]] CovariantTrajectory in_world(CovariantTrajectory path, const Similarity& S_w_v);

/// Interpolated poses at the given times: slerp of the rotation, linear in the position; without covariances.
/// @param path in order of time
/// @param times strictly increasing
/// @param max_gap_s longest interval that is interpolated across; times in longer ones, and outside of the
/// trajectory, have no pose
[[nodiscard]] Trajectory resampled(const Trajectory& path, std::span<const Timestamp> times,
                                   double max_gap_s);

}  // namespace stillpoint::eval
