// SPDX-License-Identifier: BSD-3-Clause
/// Errors of relative motions between matched poses: over frames, seconds, metres and stretches of the path.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "eval/trajectory/association.h"

namespace stillpoint {

/// A relative motion: indices of the matches where it starts and ends.
struct Motion {
  std::size_t from = 0;
  std::size_t to = 0;

  friend bool operator==(const Motion&, const Motion&) = default;
};

/// Motions that were found, and how many starts had no end within tolerance.
struct Motions {
  std::vector<Motion> motions;
  std::size_t dropped = 0;
};

/// Starts 0, step, 2 step, ... with ends `step` poses on (evo's default), or every start (evo's all_pairs).
[[nodiscard]] std::vector<Motion> motions_over_frames(std::size_t poses, std::size_t step, bool every_start);

/// From every start the pose nearest to `delta_s` later; dropped when it is off by more than `tolerance_s`,
/// so that neither a gap nor a pose paired with itself passes for motion.
[[nodiscard]] Motions motions_over_seconds(std::span<const MatchedPose> matches, double delta_s,
                                           double tolerance_s);

/// Length of the path from the first match to each [m].
enum class PathOf { kGroundTruth, kEstimate };
[[nodiscard]] std::vector<double> path_lengths(std::span<const MatchedPose> matches, PathOf of);

/// From every start the later pose whose path is nearest to `delta_m` away; dropped when off by more than
/// `tolerance_m`. The first of equally near ones. evo's all_pairs over metres, with 10 % tolerance.
/// @param lengths_m rising, as from `path_lengths`
[[nodiscard]] Motions motions_over_metres(std::span<const double> lengths_m, double delta_m,
                                          double tolerance_m);

/// Errors of motions, in their order.
struct RelativeErrors {
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  std::vector<double> yaw_deg;  ///< part of the rotation about the world's z axis, in [0, 180]
};

/// E = (G_i^-1 G_j)^-1 (E_i^-1 E_j): |p(E)|, angle of R(E), and the yaw of E told in the axes of the world,
/// R(E_j) R(E) R(E_j)^-1 (Zhang and Scaramuzza, IROS 2018). `matches` are aligned when the yaw is to mean the
/// ground truth's vertical.
[[nodiscard]] RelativeErrors relative_errors(std::span<const MatchedPose> matches,
                                             std::span<const Motion> motions);

}  // namespace stillpoint
