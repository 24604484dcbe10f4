// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose error (RPE): errors of the motion between two times, by all definitions in use. G: ground
/// truth; E: estimate; p(.), R(.): translation and rotation.
///
/// `rpe`: as evaluate_rpe.py of the TUM RGB-D benchmark computes it with --fixed_delta (Sturm et al., IROS
/// 2012). T.RPE and R.RPE of the paper, Sec. IV.
///
///   F_i   = (E_j^-1 E_i)^-1 (G_j^-1 G_i),  j = argmin_j |t_j - (t_i + delta)|
///   T.RPE = sqrt(1/N sum_i |p(F_i)|^2),  R.RPE = sqrt(1/N sum_i angle(R(F_i))^2)
///
/// E_i, E_j: estimated poses at t_i and t_j; G_i, G_j: ground truth closest in time to them; F_i: error of
/// pair i; N: number of pairs.
///
/// `relative_errors`: of pairs (i, j) of matched poses that are a fixed time, path length or number of frames
/// apart. Sources: evo_rpe; Zhang and Scaramuzza, IROS 2018 (rpg_trajectory_evaluation), for the yaw error in
/// the world frame.
///
///   F_ij  = (G_i^-1 G_j)^-1 (E_i^-1 E_j)
///   trans = |p(F_ij)|,  rot = angle(R(F_ij)),  yaw = |first ZYX Euler angle of R(E_j) R(F_ij) R(E_j)^T|
///
/// `strict_rpe`: trans and rot over pairs of matches delta_s apart, with a tolerance on the time difference,
/// so that gaps and sparse estimates do not lower the error:
///
///   j = argmin_j |t_j - (t_i + delta_s)|;  pair (i, j) is used if
///   |t_j - (t_i + delta_s)| <= min(median(t_(k+1) - t_k) / 2, delta_s / 10)
///
/// `segment_errors`: trans, rot and yaw over segments (sub-trajectories) of fixed length, as in Zhang and
/// Scaramuzza, IROS 2018: pairs (k, m) with m = argmin_m |s_m - (s_k + d)|, where s is the path length of the
/// ground truth and d the length of the segment.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/metrics/pose_pairs.h"
#include "eval/metrics/statistics.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

/// An RPE of fewer pairs is marked in tables and not ranked.
inline constexpr std::size_t kFewRpePairs = 10;

/// Of strict protocols: to each neighbor in the ground truth [s], one interval at 10 Hz plus jitter.
inline constexpr double kStrictMaxGap = 0.11;

/// trans, rot and yaw of every pair, in the order of the pairs.
struct RelativeErrors {
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  std::vector<double> yaw_deg;  ///< about the world's z axis, in [0, 180]
};

/// @param matches aligned, if the yaw error shall refer to the vertical axis of the ground truth
/// @param pairs indices into `matches`
/// @param with_yaw compute `yaw_deg`, which else is empty
/// @param recycled a result that is no longer needed; its memory is reused
[[nodiscard]] RelativeErrors relative_errors(MatchView matches, std::span<const PosePair> pairs,
                                             bool with_yaw = true, RelativeErrors recycled = {});

/// d_ij = | |p(G_j) - p(G_i)| - |p(E_j) - p(E_i)| | of every pair [m]: the relation point_distance of
/// evo_rpe.
[[nodiscard]] std::vector<double> point_distance_errors(MatchView matches, std::span<const PosePair> pairs);

/// |F - I| = sqrt(|p(F)|^2 + 8 sin^2(angle(R(F)) / 2)), the Frobenius norm of 4x4 matrices, without a unit:
/// the relation full of evo_rpe.
/// @param translation_m |p(F)|
/// @param rotation_deg angle(R(F))
[[nodiscard]] double whole_transformation_error(double translation_m, double rotation_deg);

struct RpeOptions {
  double delta = 1.0;  ///< in `unit`, > 0
  RpeUnit unit = RpeUnit::kSeconds;
  double offset_s = 0.0;  ///< added to the estimate's stamps when looking up the ground truth
};

struct RpeResult {
  Statistics translation_m;    ///< over delta; m/s for 1 s
  Statistics rotation_deg;     ///< over delta; deg/s for 1 s
  std::size_t self_pairs = 0;  ///< pairs with j = i: included by the tool, with zero error
  std::size_t dropped_gt = 0;  ///< pairs without ground truth within twice its median interval
};

/// RPE of the TUM tools, see above; t is the time, the index, the path length or the summed rotation angle of
/// a pose, depending on the unit. As in the tool there is no limit on |t_j - (t_i + delta)|, and a pair is
/// dropped if j is the last pose. Alignment does not affect the result. Uses all pairs; the tool samples
/// 10000 of them at random if there are more.
/// @return nullopt if no pair of two poses is left
[[nodiscard]] std::optional<RpeResult> rpe(const Trajectory& gt, const Trajectory& est,
                                           const RpeOptions& options = {});

/// Median interval of at most 20000 evenly spread pairs of consecutive poses [s]; 0 for fewer than two poses.
[[nodiscard]] double median_pose_interval_s(const Trajectory& path);

/// What `rpe` compares with where the ground truth has less than one pose per `kStrictMaxGap`; else empty.
[[nodiscard]] std::string sparse_truth_note(const Trajectory& gt);

struct StrictRpe {
  Statistics translation_m;  ///< over delta_s
  Statistics rotation_deg;
};

/// `errors` is absent if no pair is left.
struct StrictRpeResult {
  std::optional<StrictRpe> errors;
  std::size_t dropped = 0;   ///< starts without an end within the tolerance
  double tolerance_s = 0.0;  ///< right-hand side of the condition above
};

/// Strict RPE as defined above. A run with one pose per 2.5 s has no pair for delta_s = 1. Starts less than
/// delta_s before the last match count as dropped, too.
[[nodiscard]] StrictRpeResult strict_rpe(MatchView matches, double delta_s);

/// Matches for the strict protocols: ground truth interpolated at the stamp of each estimated pose, between
/// neighbors that are both less than `kStrictMaxGap` away.
[[nodiscard]] std::vector<MatchedPose> strict_matches(const Trajectory& gt, const Trajectory& est,
                                                      double offset_s = 0.0);

/// Errors of all segments of one length; quartiles for box plots.
struct SegmentErrors {
  double length_m = 0.0;
  Statistics translation_m;
  Statistics rotation_deg;
  Statistics yaw_deg;
  double translation_lower_quartile_m = 0.0;
  double translation_upper_quartile_m = 0.0;
  std::size_t dropped = 0;  ///< starts without an end within the tolerance
};

struct SegmentOptions {
  std::vector<double> lengths_m;  ///< empty: 10, 20, 30, 40, 50 % of the ground truth's path length
  double tolerance = 0.02;        ///< on |s_m - (s_k + d)|, relative to d
  /// Assign the k-th end found to start k even if earlier starts have no end, as rpg_trajectory_evaluation
  /// does.
  bool shift_starts = false;
};

/// @param matches aligned
/// @param options lengths of the segments and how their ends are found
/// @return one entry per length that has at least one segment
[[nodiscard]] std::vector<SegmentErrors> segment_errors(MatchView matches, const SegmentOptions& options);

/// Drift: mean over all segments of |p(F_km)| / d, in percent.
[[nodiscard]] std::optional<double> drift_percent(std::span<const SegmentErrors> segments);

}  // namespace stillpoint::eval
