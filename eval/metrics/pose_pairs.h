// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of matched poses that are a fixed time, path length, angle or number of frames apart: the relative
/// motions whose errors rpe.h computes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/fields.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

/// Of the distance between the poses of a pair.
enum class RpeUnit { kSeconds, kFrames, kMeters, kDegrees };
constexpr auto enum_names(RpeUnit) {
  return EnumNames<RpeUnit, 4>{{{RpeUnit::kSeconds, "s"},
                                {RpeUnit::kFrames, "f"},
                                {RpeUnit::kMeters, "m"},
                                {RpeUnit::kDegrees, "deg"}}};
}

/// Start and end of a relative motion, as indices of matches.
struct PosePair {
  PoseIndex from = 0;
  PoseIndex to = 0;

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
[[nodiscard]] PosePairs pairs_over_seconds(MatchView matches, double delta_s, double tolerance_s);

/// Path length from the first match to each [m].
enum class PathOf { kGroundTruth, kEstimate };
[[nodiscard]] std::vector<double> path_lengths(MatchView matches, PathOf of);

/// Rotation angle of the ground truth from the first match to each, summed over consecutive ones [deg].
[[nodiscard]] std::vector<double> path_angles_deg(MatchView matches);

/// Pairs every match with the later one whose path length from it is closest to `delta_m`, the first of
/// equally close ones. Also for angles, in degrees. Pairs that miss `delta_m` by more than `tolerance_m` are
/// dropped. Same pairs as evo's all_pairs in meters, which has a tolerance of 10 %.
/// @param lengths_m non-decreasing, as from `path_lengths`
/// @param delta_m desired path length between the matches of a pair
/// @param tolerance_m inclusive
[[nodiscard]] PosePairs pairs_over_meters(std::span<const double> lengths_m, double delta_m,
                                          double tolerance_m);

inline constexpr double kSegmentTolerance = 0.02;  ///< relative to the length of a segment, or to delta [m]

/// Of pairs over seconds, see `strict_rpe` [s].
[[nodiscard]] double strict_tolerance_s(MatchView matches, double delta_s);

/// Every start, and the end closest to delta later. Tolerances: `strict_tolerance_s` over seconds, 2 % of
/// delta over meters of the ground truth, 10 % of delta over degrees of its summed rotation; over frames, all
/// pairs of matches that are as many apart.
/// @param matches in temporal order
/// @param delta > 0
/// @param unit of delta
[[nodiscard]] PosePairs strict_pairs(MatchView matches, double delta, RpeUnit unit);

}  // namespace stillpoint::eval
