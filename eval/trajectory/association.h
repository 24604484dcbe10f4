// SPDX-License-Identifier: BSD-3-Clause
/// Association of estimated poses with ground truth by time stamp, and the check that both are of the same
/// time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// Index of a pose or a stamp: a text file of 4 GB has fewer rows.
using PoseIndex = std::uint32_t;

/// Indices into the ground truth and the estimate.
struct IndexPair {
  PoseIndex gt = 0;
  PoseIndex est = 0;

  friend bool operator==(const IndexPair&, const IndexPair&) = default;
};

/// How differences of stamps are computed: exactly, in nanoseconds, or in double precision as in the public
/// tools. A double resolves Unix time to 0.24 us only; the rounding decides ties, so reproducing a tool needs
/// its arithmetic.
enum class StampArithmetic { kExact, kDouble };

struct AssociationOptions {
  double max_difference_s = 0.02;  ///< of the stamps of a pair; exclusive (TUM) or inclusive (evo)
  double offset_s = 0.0;           ///< added to the estimate's stamps
  StampArithmetic arithmetic = StampArithmetic::kExact;
};

/// Association of the TUM RGB-D tools (associate.py): all candidates with
/// |t_gt - (t_est + offset_s)| < max_difference_s, sorted by the difference, matched greedily and one-to-one.
/// O((n + m) log(n + m)).
/// @param gt, est strictly increasing
/// @param options `arithmetic` decides between candidates with equal differences
/// @return pairs in order of time
[[nodiscard]] std::vector<IndexPair> associate_tum(std::span<const Timestamp> gt,
                                                   std::span<const Timestamp> est,
                                                   const AssociationOptions& options = {});
[[nodiscard]] std::vector<IndexPair> associate_tum(const Trajectory& gt, const Trajectory& est,
                                                   const AssociationOptions& options = {});

/// Association of evo: each stamp of the shorter trajectory with the closest stamp of the longer one, kept if
/// at most max_difference_s apart. Not one-to-one: a pose of the longer trajectory may occur twice. O(n + m).
[[nodiscard]] std::vector<IndexPair> associate_evo(const Trajectory& gt, const Trajectory& est,
                                                   const AssociationOptions& options = {});

/// A pair whose ground truth is interpolated between the poses `gt` and `gt + 1`.
struct InterpolatedPair {
  PoseIndex gt = 0;
  PoseIndex est = 0;
  double fraction = 0.0;  ///< 0 at pose `gt`, 1 at pose `gt + 1`; in [0, 1)
};

/// One pair for each estimated pose whose two neighbors in the ground truth are both less than `max_gap_s`
/// away. As in the OpenLORIS tools (Shi et al., ICRA 2020), with max_gap_s = 0.5. O(n + m).
[[nodiscard]] std::vector<InterpolatedPair> associate_interpolated(const Trajectory& gt,
                                                                   const Trajectory& est, double max_gap_s,
                                                                   double offset_s = 0.0);

/// The stamp in seconds, rounded as when its decimal text is parsed to a double.
[[nodiscard]] double stamp_as_double(Timestamp t);

/// a - (b + b_offset_s) [s]; `kExact` subtracts integers and rounds once.
[[nodiscard]] double stamp_difference(Timestamp a, Timestamp b, double b_offset_s,
                                      StampArithmetic arithmetic);

/// @param gt, est not empty
/// @param offset_s added to the stamps of the estimate
/// @param place the estimate, as the user wrote it
/// @throws InputError if no stamp of one lies between the first and the last of the other
void require_overlap(const Trajectory& gt, const Trajectory& est, double offset_s, const std::string& place);

}  // namespace stillpoint::eval
