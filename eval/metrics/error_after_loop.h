// SPDX-License-Identifier: BSD-3-Clause
/// Effect of loop closure while running: the errors of the odometry and of the causal trajectory, which
/// has the corrections known at each frame, once loops correct it.
///
///   e(T) = sqrt(1/N sum |S p(T_k) - p(G_k)|^2)   over the frames k with t_k >= t_1 + 1 s
///   ratio = e(causal) / e(odometry)
///
/// G_k, T_k: true and estimated poses; p(.): their translation; t_1: time of the query of the first accepted
/// loop; S: rigid alignment (see alignment.h) over the first 10 s of the odometry, at most up to t_1. The
/// correction by that loop may be known later still, when its keyframe has left the window: the frames until
/// then are scored, too.
///
/// The alignment does not use what is scored: over the whole trajectory it would distribute the drift to both
/// sides of the loop, and hide a part of what the loop removes. It uses the start and not all frames before
/// t_1, as loops correct the drift relative to the start, and the odometry drifts up to t_1. An error of S
/// adds to both values and moves the ratio towards 1.
#pragma once

#include <optional>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

struct ErrorAfterLoop {
  double odometry_m = 0.0;
  double causal_m = 0.0;
  std::optional<double> ratio;  ///< nullopt if the odometry has no error
};

/// Frames that one of both trajectories lacks are left out.
/// @param gt, odometry, causal in order of time; `causal` is equal to `odometry` before `first_loop`
/// @param first_loop t_1
/// @return nullopt without frames to score, or if the positions of the start do not determine S
[[nodiscard]] std::optional<ErrorAfterLoop> error_after_loop(const Trajectory& gt, const Trajectory& odometry,
                                                             const Trajectory& causal, Timestamp first_loop);

}  // namespace stillpoint::eval
