// SPDX-License-Identifier: BSD-3-Clause
/// Metrics of loop closure: precision and recall from true poses, and its effect while running.
///
/// A loop between query q and match m with the claimed pose T_mq of the camera at q in that at m is true if
///
///   E = (G_m^-1 G_q)^-1 T_mq,   |trans(E)| <= 20 cm   and   angle(rot(E)) <= 5 deg
///
/// G: true camera poses. Keyframe k is a revisit if an earlier keyframe is at most 1 m and 30 degrees away
/// from it, and a keyframe between both is more than twice as far away in position or rotation: the camera
/// left the place and returned. It is recognized if it is the query of an accepted true loop.
///
///   recall = recognized revisits / revisits
///
/// The effect is the ratio of the errors of the causal trajectory, which has the corrections known at each
/// frame, and of the odometry, once loops correct it.
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

#include <cstddef>
#include <optional>
#include <span>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

/// A loop as reported by a system.
struct ReportedLoop {
  Timestamp query_t;
  Timestamp match_t;
  Pose T_match_query;  ///< of the cameras
  bool accepted = false;
};

struct RevisitLimits {
  double loop_m = 0.2;  ///< largest error of a true loop
  double loop_deg = 5.0;
  double place_m = 1.0;  ///< extent of a place
  double place_deg = 30.0;
};

struct RevisitScore {
  std::size_t true_loops = 0;    ///< accepted
  std::size_t false_loops = 0;   ///< accepted, but off by more than the limits
  std::size_t missed_loops = 0;  ///< not accepted although within the limits
  std::size_t revisits = 0;      ///< keyframes at a place of an earlier keyframe
  std::size_t recognized = 0;    ///< revisits with an accepted true loop
  std::optional<double> recall;  ///< in [0, 1]; nullopt without revisits
};

/// Loops and keyframes without a true pose within 50 ms are left out. Time is quadratic in the keyframes.
/// @param gt true poses T_w_c of the camera, in order of time
/// @param keyframes times at which places are recognized, in order
/// @param loops in any order
/// @param limits all > 0
[[nodiscard]] RevisitScore score_revisits(const Trajectory& gt, std::span<const Timestamp> keyframes,
                                          std::span<const ReportedLoop> loops,
                                          const RevisitLimits& limits = {});

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
