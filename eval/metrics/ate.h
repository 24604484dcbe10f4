// SPDX-License-Identifier: BSD-3-Clause
/// Absolute trajectory error (ATE): pose errors after alignment (Sturm et al., IROS 2012; paper Sec. IV); and
/// the fractions of a sequence with a pose (coverage) and with a correct one (correct rate).
///
///   e_k     = |S p(E_k) - p(G_k)|                  translation error of pair k [m]
///   theta_k = angle((R_S R(E_k))^T R(G_k))         rotation error of pair k
///   ATE     = sqrt(1/N sum_k e_k^2)
///
/// G_k, E_k: matched poses of ground truth and estimate; p(.), R(.): their translation and rotation; S: the
/// alignment (see alignment.h) with rotation R_S; N: number of pairs.
///
/// A pose at t_k is valid during [t_k, t_k + h_k], h_k = min(max_hold_s, t_(k+1) - t_k). With the ground
/// truth over [t_first, t_last]:
///
///   time coverage = sum_k h_k / (t_last - t_first)
///   correct rate  = sum over {k: e_k <= max_translation_m, theta_k <= max_rotation_deg} of h_k
///                   / (t_last - t_first)
///
/// Source of the correct rate: Shi et al., "Are We Ready for Service Robots? The OpenLORIS-Scene Datasets",
/// ICRA 2020, with max_hold_s = 1.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/alignment.h"
#include "eval/trajectory/orientations.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

/// e_k and theta_k of every pair, in the order of the matches.
struct AteErrors {
  std::vector<double> translation_m;  ///< e_k
  std::vector<double> rotation_deg;   ///< theta_k, in [0, 180]
};

[[nodiscard]] AteErrors ate_errors(MatchView matches, const Similarity& S_w_v);

/// The same with rotations after the completed alignment, see orientations.h.
[[nodiscard]] AteErrors ate_errors(MatchView matches, const Similarity& S_w_v,
                                   const CompletedAlignment& completed);

/// RMSE of e_k [m], without the other values of `ate_errors`; NaN without matches.
[[nodiscard]] double position_rmse(MatchView matches, const Similarity& S_w_v);

struct AteResult {
  Statistics translation_m;
  Statistics rotation_deg;
  AlignmentResult alignment;
  std::size_t pairs = 0;
};

/// ATE as evaluate_ate.py of the TUM RGB-D benchmark computes it: `associate_tum`, then SE(3) alignment over
/// all pairs.
/// @return nullopt for fewer than two pairs
[[nodiscard]] std::optional<AteResult> ate(const Trajectory& gt, const Trajectory& est,
                                           const AssociationOptions& options = {});

/// Rotation angle [rad] in [0, pi]: 2 atan2(|q_v|, |q_w|). Accurate near 0 and pi, where
/// arccos((trace(R) - 1) / 2) is not.
[[nodiscard]] double rotation_angle(const Eigen::Quaterniond& q);

/// Fraction of the frames that have a pose. A pose belongs to at most one frame and a frame to at most one
/// pose, which are at most max(tolerance_s, d / 2) apart, d: median interval of the frames. Poses of a system
/// that reports more often than there are frames, e.g. at 100 Hz, have no frame of their own and do not
/// count.
/// @param est poses with strictly increasing stamps
/// @param expected frame times of the sequence, strictly increasing
/// @param tolerance_s greater than the rounding of stamps in files
/// @return in [0, 1]; nullopt if `expected` is empty
[[nodiscard]] std::optional<double> coverage(const Trajectory& est, std::span<const Timestamp> expected,
                                             double tolerance_s = 1e-3);

/// Time from `start` to the first pose [s], 0 for a pose before `start`; nullopt without a pose.
[[nodiscard]] std::optional<double> first_pose_seconds(const Trajectory& est, Timestamp start);

struct TimeSpan {
  Timestamp begin;
  Timestamp end;
};

/// Intervals of `whole` without a valid pose, in order of time. A pose is valid from its stamp to the next
/// one, for at most `max_hold_s`.
[[nodiscard]] std::vector<TimeSpan> lost_spans(const Trajectory& est, const TimeSpan& whole,
                                               double max_hold_s);

/// Fraction of `whole` outside the lost spans; nullopt if `whole` has no duration.
[[nodiscard]] std::optional<double> time_coverage(std::span<const TimeSpan> lost, const TimeSpan& whole);

/// Error thresholds of a correct pose, and how long a pose stays valid.
struct CorrectRateOptions {
  double max_translation_m = std::numeric_limits<double>::infinity();
  double max_rotation_deg = std::numeric_limits<double>::infinity();
  double max_hold_s = 1.0;  ///< a pose is valid until the next one, at most this long
};

/// Largest distance in time of a pose from both neighbors in the ground truth, for the correct rate; value of
/// the OpenLORIS tools.
inline constexpr double kCorrectRateGap_s = 0.5;

/// Correct rate as defined above, after SE(3) alignment over all matches. Ground truth is interpolated
/// between neighbors that are both less than 0.5 s away.
/// @return 0 if fewer than two poses match, as one is aligned without an error; nullopt if they do not match
/// because the ground truth at their time is too sparse, if the ground truth has fewer than two poses, or if
/// neither positions nor orientations determine the rotation of the alignment, unless `max_rotation_deg` is
/// infinite
[[nodiscard]] std::optional<double> correct_rate(const Trajectory& gt, const Trajectory& est,
                                                 const CorrectRateOptions& options = {},
                                                 double offset_s = 0.0);

/// Correct rate of matched poses.
/// @param matches in order of time, of neighbors in the ground truth at most `kCorrectRateGap_s` away
/// @param errors of `matches`, after SE(3) alignment over all of them
/// @param gt two poses or more
/// @param options thresholds of e_k and theta_k; how long a pose is valid
[[nodiscard]] double correct_rate(MatchView matches, const AteErrors& errors, const Trajectory& gt,
                                  const CorrectRateOptions& options);

/// Numerator of the correct rate [s].
/// @param matches in order of time
/// @param errors e_k and theta_k of `matches`
/// @param end end of the validity of the last pose, if `max_hold_s` does not end it before
/// @param options thresholds of e_k and theta_k; how long a pose is valid
[[nodiscard]] double correct_seconds(MatchView matches, const AteErrors& errors, Timestamp end,
                                     const CorrectRateOptions& options);

}  // namespace stillpoint::eval
