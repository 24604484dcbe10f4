// SPDX-License-Identifier: BSD-3-Clause
/// Constant time offset between an estimate and its ground truth.
///
/// Candidates are the lags at which the motion of both agrees best: speed and rotation rate, which depend on
/// neither world nor body frame, on a common grid of times. Score of a lag: mean over both signals of
///
///   r(lag) = sum_k (a_k - a~)(b_(k-lag) - b~) / sqrt(sum_k (a_k - a~)^2 sum_k (b_(k-lag) - b~)^2)
///
/// a, b: the signal of ground truth and estimate; a~, b~: their means over the common grid points k. If no
/// lag agrees, the score is computed once more on a grid of four times the step, over which the noise of
/// poses is a smaller part of the speed. The offset is the candidate with the smallest ATE after similarity
/// alignment, in which a wrong scale is no offset, refined by golden-section search.
#pragma once

#include <optional>
#include <string>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

struct TimeOffset {
  double offset_s = 0.0;            ///< to be added to the estimate's stamps
  double ate_rmse_m = 0.0;          ///< at this offset, after SE(3) alignment
  double ate_rmse_at_zero_m = 0.0;  ///< at offset 0; infinite with fewer than ten matches
  /// Why the offset is not determined: the motion does not tell it, or two offsets are equally good. Empty if
  /// it is determined.
  std::string undetermined;
};

/// The offset at which the estimate agrees best with the ground truth, at any lag with a common duration of
/// at least 40 % of the shorter file. No protocol applies it automatically, because it would also hide the
/// estimator's latency.
/// @return nullopt if either has fewer than ten poses
[[nodiscard]] std::optional<TimeOffset> find_time_offset(const Trajectory& gt, const Trajectory& est);

}  // namespace stillpoint::eval
