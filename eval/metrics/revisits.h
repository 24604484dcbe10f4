// SPDX-License-Identifier: BSD-3-Clause
/// Precision and recall of loop closure, from true poses.
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

}  // namespace stillpoint::eval
