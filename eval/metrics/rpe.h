// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose error: how far the motion over a fixed span is off. T.RPE and R.RPE of the paper, Sec. IV.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "eval/metrics/statistics.h"
#include "eval/trajectory/association.h"

namespace stillpoint {

struct RpeOptions {
  double delta_s = 1.0;
  double offset_s = 0.0;  ///< added to the estimate's stamps when looking up the ground truth
  /// A pair is dropped when its span differs from delta_s by more: infinite reproduces the TUM tools, which
  /// know no such limit and so take any two poses around a gap, or one pose with itself.
  double max_span_error_s = std::numeric_limits<double>::infinity();
};

struct RpeResult {
  Statistics translation_m;  ///< over delta_s; m/s for delta_s = 1
  Statistics rotation_deg;   ///< over delta_s; deg/s for delta_s = 1
  std::size_t pairs = 0;
  std::size_t dropped_span = 0;  ///< pairs without a partner at the right distance
  std::size_t dropped_gt = 0;    ///< pairs without a ground truth within twice its median interval
};

/// RPE of the TUM RGB-D tools with a fixed time delta: each estimate i is paired with the estimate nearest to
/// t_i + delta, unless that is the last; error (E_j^-1 E_i)^-1 (G_j^-1 G_i). No alignment takes part. All
/// pairs are used where the tool draws 10000 at random. Nothing when no pair is left.
/// Sturm et al., IROS 2012.
[[nodiscard]] std::optional<RpeResult> rpe(const Trajectory& gt, const Trajectory& est,
                                           const RpeOptions& options = {});

}  // namespace stillpoint
