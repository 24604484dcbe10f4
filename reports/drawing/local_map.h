// SPDX-License-Identifier: BSD-3-Clause
/// Plan of trajectories with a scale bar and an arrow to the north; without a map of the surroundings.
#pragma once

#include <vector>

#include "reports/drawing/trajectory_plot.h"

namespace stillpoint::report {

/// x of the ground truth to the right and y up, to scale: east and north if the ground truth is that of a
/// GNSS receiver (eval/io/nmea_file.h). Estimates are drawn as aligned by their evaluation; all of each
/// trajectory is visible.
[[nodiscard]] Drawing local_map(const Trajectory& gt, const std::vector<PlottedRun>& runs);

/// Length of a scale bar: the largest of 1, 2, 5, 10, ... [m] that is at most a third of `width_m`.
[[nodiscard]] double scale_bar_m(double width_m);

}  // namespace stillpoint::report
