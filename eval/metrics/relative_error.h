// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose errors between pairs of matched poses that are a fixed time, path length or number of frames
/// apart.
///
///   F_ij  = (G_i^-1 G_j)^-1 (E_i^-1 E_j)
///   trans = |p(F_ij)|,  rot = angle(R(F_ij)),  yaw = |first ZYX Euler angle of R(E_j) R(F_ij) R(E_j)^T|
///
/// G, E: ground truth and estimate; i, j: start and end of the pair; p(.), R(.): translation, rotation.
/// Sources: evo_rpe; Zhang and Scaramuzza, IROS 2018 (rpg_trajectory_evaluation), for the yaw error in the
/// world frame.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "eval/trajectory/association.h"

namespace stillpoint::eval {

/// Start and end of a relative motion, as indices of matches.
struct PosePair {
  std::size_t from = 0;
  std::size_t to = 0;

  friend bool operator==(const PosePair&, const PosePair&) = default;
};

/// Pairs found, and the number of starts without an end within the tolerance.
struct PosePairs {
  std::vector<PosePair> pairs;
  std::size_t dropped = 0;
};

/// Pairs (i, i + step) for i = 0, step, 2 step, ... (default of evo), or for every i (evo's all_pairs).
[[nodiscard]] std::vector<PosePair> pairs_over_frames(std::size_t poses, std::size_t step, bool every_start);

/// Pairs every match with the one whose time is closest to `delta_s` later. Pairs that miss `delta_s` by more
/// than `tolerance_s` are dropped, so a gap does not distort the error and no pose is paired with itself.
[[nodiscard]] PosePairs pairs_over_seconds(std::span<const MatchedPose> matches, double delta_s,
                                           double tolerance_s);

/// Path length from the first match to each [m].
enum class PathOf { kGroundTruth, kEstimate };
[[nodiscard]] std::vector<double> path_lengths(std::span<const MatchedPose> matches, PathOf of);

/// Pairs every match with the later one whose path length from it is closest to `delta_m`, the first of
/// equally close ones. Pairs that miss `delta_m` by more than `tolerance_m` are dropped. Same pairs as evo's
/// all_pairs in meters, which has a tolerance of 10 %.
/// @param lengths_m non-decreasing, as from `path_lengths`
/// @param delta_m desired path length between the matches of a pair
/// @param tolerance_m inclusive
[[nodiscard]] PosePairs pairs_over_meters(std::span<const double> lengths_m, double delta_m,
                                          double tolerance_m);

/// trans, rot and yaw of every pair, in the order of the pairs.
struct RelativeErrors {
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  std::vector<double> yaw_deg;  ///< about the world's z axis, in [0, 180]
};

/// @param matches aligned, if the yaw error shall refer to the vertical axis of the ground truth
/// @param pairs indices into `matches`
[[nodiscard]] RelativeErrors relative_errors(std::span<const MatchedPose> matches,
                                             std::span<const PosePair> pairs);

}  // namespace stillpoint::eval
