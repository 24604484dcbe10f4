// SPDX-License-Identifier: BSD-3-Clause
/// Paths from above and their errors over time.
#pragma once

#include <string>
#include <vector>

#include "core/types/trajectory.h"
#include "eval/recipes/recipe.h"
#include "reports/drawing.h"

namespace stillpoint {

/// One estimate with what a recipe says about it.
struct PlottedRun {
  std::string name;
  const Trajectory* est = nullptr;
  const Evaluation* evaluation = nullptr;
};

/// Upper part: ground truth (black) and aligned estimates in the two axes along which the ground truth is
/// longest, to scale. Lower part: position error [m] over time [s].
[[nodiscard]] Drawing trajectory_plot(const Trajectory& gt, const std::vector<PlottedRun>& runs);

}  // namespace stillpoint
