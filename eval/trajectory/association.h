// SPDX-License-Identifier: BSD-3-Clause
/// Which pose of the ground truth belongs to which pose of the estimate.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/types/trajectory.h"

namespace stillpoint {

/// Indices into the ground truth and the estimate.
struct IndexPair {
  std::size_t gt = 0;
  std::size_t est = 0;

  friend bool operator==(const IndexPair&, const IndexPair&) = default;
};

/// How differences of stamps are computed. The public tools hold stamps in doubles, whose step is 0.24 us for
/// Unix stamps; that decides ties, so reproducing a tool needs its arithmetic.
enum class StampArithmetic { kExact, kDouble };

struct AssociationOptions {
  double max_difference_s = 0.02;  ///< a pair's stamps differ by less (TUM) or at most (evo) this
  double offset_s = 0.0;           ///< added to the estimate's stamps
  StampArithmetic arithmetic = StampArithmetic::kExact;
};

/// Pairs of the TUM RGB-D tools: candidates |t_gt - (t_est + offset)| < max_difference_s, taken greedily from
/// the smallest difference on, each pose at most once. In order of time. O((n + m) log(n + m)).
/// @param gt, est poses with strictly rising stamps
[[nodiscard]] std::vector<IndexPair> associate_tum(const Trajectory& gt, const Trajectory& est,
                                                   const AssociationOptions& options = {});

/// Pairs of evo: each stamp of the shorter trajectory with the nearest of the longer, kept if at most
/// max_difference_s apart. Not one-to-one: a pose of the longer trajectory may be taken twice. O(n + m).
[[nodiscard]] std::vector<IndexPair> associate_evo(const Trajectory& gt, const Trajectory& est,
                                                   const AssociationOptions& options = {});

/// A pair whose ground truth is `share` of the way from pose `gt` to pose `gt + 1`.
struct InterpolatedPair {
  std::size_t gt = 0;
  std::size_t est = 0;
  double share = 0.0;  ///< in [0, 1)
};

/// Every estimate inside the ground truth's time whose two neighbours there are both nearer than `max_gap_s`.
/// OpenLORIS tools (Shi et al., ICRA 2020) with max_gap_s = 0.5. O(n + m).
[[nodiscard]] std::vector<InterpolatedPair> associate_interpolated(const Trajectory& gt,
                                                                   const Trajectory& est, double max_gap_s,
                                                                   double offset_s = 0.0);

/// Both poses at the estimate's stamp.
struct MatchedPose {
  Timestamp t;  ///< of the estimate, as written in its file
  Pose gt;      ///< T_w_f, w the world of the ground truth
  Pose est;     ///< T_v_f, v the world of the estimate
};

/// The poses that pairs of indices stand for.
[[nodiscard]] std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                                     std::span<const IndexPair> pairs);

/// The same with the ground truth interpolated: slerp of the rotation, straight line of the position.
[[nodiscard]] std::vector<MatchedPose> matched_poses(const Trajectory& gt, const Trajectory& est,
                                                     std::span<const InterpolatedPair> pairs);

/// The double that a program holds after reading the stamp's decimal text.
[[nodiscard]] double stamp_as_double(Timestamp t);

/// a - (b + b_offset_s) [s]; in `kExact` by integers, rounded once.
[[nodiscard]] double stamp_difference(Timestamp a, Timestamp b, double b_offset_s,
                                      StampArithmetic arithmetic);

}  // namespace stillpoint
