// SPDX-License-Identifier: BSD-3-Clause
/// Time of the loop closure per keyframe, and the memory that it uses, over a run.
#pragma once

#include <span>

#include "core/types/loop_report.h"
#include "reports/drawing/drawing.h"

namespace stillpoint::report {

/// Discs: median time of the keyframes of windows of equal length; line: memory at the center of each window.
/// Each has a scale of its own from 0 to the largest value, which the labels state.
/// @param keyframes by time
/// @param window_s length of a window; its median suppresses the keyframes at which the graph is optimized
/// @throws InputError if the keyframes extend over fewer than three windows
[[nodiscard]] Drawing loop_cost_plot(std::span<const MapKeyframe> keyframes, double window_s = 10.0);

}  // namespace stillpoint::report
