// SPDX-License-Identifier: BSD-3-Clause
/// What orientations tell that positions do not: the rotation of an alignment about a straight path or at a
/// standing camera, and whether two trajectories have orientations that can be compared.
///
/// Positions on a line determine the alignment up to a rotation about it; noise across the line is no
/// information. The angle a about the unit vector u of the line then maximizes the agreement of orientations
///
///   sum_i trace(exp(u a)^T D_i),  D_i = R(G_i) (R_S R(E_i))^T
///   a = atan2(sum_i u . vee(D_i - D_i^T), sum_i (trace D_i - u^T D_i u))
///
/// R_S: rotation of the alignment; G_i, E_i: matched poses; vee(M) = (M_32, M_13, M_21). At a standing
/// camera, the whole rotation is the one closest to the sum of D_i (Umeyama, IEEE PAMI 13, 1991).
#pragma once

#include <span>
#include <string>

#include "eval/trajectory/alignment.h"

namespace stillpoint::eval {

/// What determines the rotation of an alignment.
enum class RotationSource {
  kPositions,   ///< the path extends in two directions
  kLine,        ///< a straight path: the rotation about it is that of the orientations
  kStanding,    ///< no path: the rotation is that of the orientations
  kUnlikePath,  ///< paths that do not follow each other, as with a wrong clock: same
};

struct CompletedAlignment {
  Similarity S_w_v;  ///< maps the mean position as the given alignment does
  RotationSource source = RotationSource::kPositions;
  bool determined = true;  ///< false: the orientations contradict each other, and S_w_v is as given
};

/// The alignment with the part of its rotation that the positions do not determine taken from the
/// orientations. A path is a line if its standard deviation across is less than 5 % of that along, and less
/// than three times the RMSE of the aligned positions (of an estimate, which may have another scale, only an
/// exact line counts); it stands if the standard deviation is less than 5 cm and three times the RMSE, or if
/// the correlation of the aligned positions is less than 0.5. The orientations decide if the mean cosine of
/// the angles between them is at least 0.5.
/// @param matches positions and orientations
/// @param S_w_v an alignment of the positions
/// @param kind of that alignment: yaw is determined by a path that is no vertical line; kNone and kFirstPose
/// have no fitted rotation and remain
[[nodiscard]] CompletedAlignment complete_rotation(MatchView matches, const Similarity& S_w_v,
                                                   Alignment kind = Alignment::kSe3);

/// Why rotation errors and relative errors, which depend on orientations, mean nothing: the orientations of
/// one trajectory are all equal (a system or receiver without orientations), while the other turns by more
/// than 5 deg, or they differ from those of the other by an RMS of more than 5 deg after alignment.
/// @param gt, est ground truth and estimate
/// @param offset_s added to the stamps of the estimate
/// @return a sentence without a full stop; empty if the orientations can be compared
[[nodiscard]] std::string missing_orientations(const Trajectory& gt, const Trajectory& est,
                                               double offset_s = 0.0);

}  // namespace stillpoint::eval
