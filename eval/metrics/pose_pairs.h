// SPDX-License-Identifier: BSD-3-Clause
/// Pairs of poses of the strict protocols, and the relations point_distance and full of evo_rpe.
///
///   d_ij = | |p(G_j) - p(G_i)| - |p(E_j) - p(E_i)| |
///   |F - I| = sqrt(|p(F)|^2 + 8 sin^2(angle(R(F)) / 2)), the Frobenius norm of 4x4 matrices, without a unit
///
/// G: ground truth; E: estimate; F: error of a pose or a pair (rpe.h); p(.), R(.): translation and rotation.
#pragma once

#include <span>
#include <vector>

#include "eval/metrics/rpe.h"

namespace stillpoint::eval {

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

/// d_ij of every pair [m].
[[nodiscard]] std::vector<double> point_distance_errors(MatchView matches, std::span<const PosePair> pairs);

/// |F - I|.
/// @param translation_m |p(F)|
/// @param rotation_deg angle(R(F))
[[nodiscard]] double whole_transformation_error(double translation_m, double rotation_deg);

}  // namespace stillpoint::eval
