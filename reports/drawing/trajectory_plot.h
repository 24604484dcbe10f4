// SPDX-License-Identifier: BSD-3-Clause
/// Drawings of trajectories: top view with position errors over time, and plan with a scale bar and an arrow
/// to the north, without a map of the surroundings.
#pragma once

#include <string>
#include <vector>

#include "core/types/trajectory.h"
#include "eval/protocols/protocol.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::report {

/// One estimated trajectory and its evaluation.
struct PlottedRun {
  std::string name;
  const Trajectory* est = nullptr;
  const eval::Evaluation* evaluation = nullptr;
};

/// Upper part: ground truth (black) and aligned estimates in the two axes along which the ground truth is
/// longest, to scale and completely visible. Lower part: position error [m] over time [s].
[[nodiscard]] Drawing trajectory_plot(const Trajectory& gt, const std::vector<PlottedRun>& runs);

/// x of the ground truth to the right and y up, to scale: east and north if the ground truth is that of a
/// GNSS receiver (eval/io/nmea_file.h). Estimates are drawn as aligned by their evaluation; all of each
/// trajectory is visible.
[[nodiscard]] Drawing local_map(const Trajectory& gt, const std::vector<PlottedRun>& runs);

/// Length of a scale bar: the largest of 1, 2, 5, 10, ... [m] that is at most a third of `width_m`.
[[nodiscard]] double scale_bar_m(double width_m);

}  // namespace stillpoint::report
