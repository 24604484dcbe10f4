// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose error: how far the motion over a fixed span is off. T.RPE and R.RPE of the paper, Sec. IV.
#pragma once

#include <cstddef>
#include <optional>

#include "core/base/fields.h"
#include "eval/metrics/statistics.h"
#include "eval/trajectory/association.h"

namespace stillpoint {

enum class RpeUnit { kSeconds, kFrames, kMetres };
constexpr auto enum_names(RpeUnit) {
  return EnumNames<RpeUnit, 3>{{{RpeUnit::kSeconds, "s"}, {RpeUnit::kFrames, "f"}, {RpeUnit::kMetres, "m"}}};
}

struct RpeOptions {
  double delta = 1.0;  ///< in `unit`, > 0
  RpeUnit unit = RpeUnit::kSeconds;
  double offset_s = 0.0;  ///< added to the estimate's stamps when looking up the ground truth
};

struct RpeResult {
  Statistics translation_m;    ///< over delta; m/s for 1 s
  Statistics rotation_deg;     ///< over delta; deg/s for 1 s
  std::size_t self_pairs = 0;  ///< pairs of a pose with itself: they count as errors of 0 in the tool
  std::size_t dropped_gt = 0;  ///< pairs without a ground truth within twice its median interval
};

/// RPE of the TUM RGB-D tools with a fixed delta (Sturm et al., IROS 2012): each estimate i is paired with
/// the estimate nearest to i + delta (of time, of number, of path), however far that is, unless it is the
/// last; error (E_j^-1 E_i)^-1 (G_j^-1 G_i). No alignment takes part. All pairs are used where the tool draws
/// 10000 at random. Nothing when no pair is left.
[[nodiscard]] std::optional<RpeResult> rpe(const Trajectory& gt, const Trajectory& est,
                                           const RpeOptions& options = {});

}  // namespace stillpoint
