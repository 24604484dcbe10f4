// SPDX-License-Identifier: BSD-3-Clause
/// Top view of trajectories and their position errors over time.
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

}  // namespace stillpoint::report
