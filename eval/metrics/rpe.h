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
///
/// `FrameToFrameError`: trans between consecutive frames, independent of the alignment.
///
///   e_k = |p((G_(k-1)^-1 G_k)^-1 (E_(k-1)^-1 E_k))|
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/fields.h"
#include "eval/metrics/statistics.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

/// An RPE of fewer pairs is marked in tables and not ranked.
inline constexpr std::size_t kFewRpePairs = 10;

/// Of strict protocols: to each neighbor in the ground truth [s], one interval at 10 Hz plus jitter.
inline constexpr double kStrictMaxGap = 0.11;

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

enum class RpeUnit { kSeconds, kFrames, kMeters, kDegrees };
constexpr auto enum_names(RpeUnit) {
  return EnumNames<RpeUnit, 4>{{{RpeUnit::kSeconds, "s"},
                                {RpeUnit::kFrames, "f"},
                                {RpeUnit::kMeters, "m"},
                                {RpeUnit::kDegrees, "deg"}}};
}

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

/// Relative pose error between each frame and the previous one.
class FrameToFrameError {
 public:
  /// To be called for every frame in order.
  /// @param pose estimate and ground truth of the frame; nullopt if either is missing
  /// @return e_k [m]; infinity at the first frame without a pose after one with a pose; NaN at other frames
  ///         where this frame or the previous one has no pose
  [[nodiscard]] double next(const std::optional<MatchedPose>& pose);

 private:
  std::optional<MatchedPose> previous_;
};

/// The `capacity` frames with the largest values.
class WorstFrames {
 public:
  explicit WorstFrames(std::size_t capacity) : capacity_(capacity) {}

  struct Insertion {
    bool inserted = false;
    std::optional<std::size_t> evicted;  ///< frame removed to stay within the capacity
  };

  /// Among equal values, frames inserted earlier rank higher. NaN is ignored.
  Insertion insert(std::size_t frame, double value);

  /// In order of decreasing value.
  [[nodiscard]] std::vector<std::size_t> frames() const;

 private:
  struct Entry {
    std::size_t frame = 0;
    double value = 0.0;
  };
  std::size_t capacity_;
  std::vector<Entry> entries_;  ///< in order of decreasing value
};

}  // namespace stillpoint::eval
