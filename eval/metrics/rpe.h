// SPDX-License-Identifier: BSD-3-Clause
/// Relative pose error (RPE) as evaluate_rpe.py of the TUM RGB-D benchmark computes it with --fixed_delta
/// (Sturm et al., IROS 2012). T.RPE and R.RPE of the paper, Sec. IV.
///
///   F_i   = (E_j^-1 E_i)^-1 (G_j^-1 G_i),  j = argmin_j |t_j - (t_i + delta)|
///   T.RPE = sqrt(1/N sum_i |p(F_i)|^2),  R.RPE = sqrt(1/N sum_i angle(R(F_i))^2)
///
/// E_i, E_j: estimated poses at t_i and t_j; G_i, G_j: ground truth closest in time to them; F_i: error of
/// pair i; p(.), R(.): translation and rotation; N: number of pairs.
#pragma once

#include <cstddef>
#include <optional>

#include "core/base/fields.h"
#include "eval/metrics/statistics.h"
#include "eval/trajectory/association.h"

namespace stillpoint::eval {

enum class RpeUnit { kSeconds, kFrames, kMeters };
constexpr auto enum_names(RpeUnit) {
  return EnumNames<RpeUnit, 3>{{{RpeUnit::kSeconds, "s"}, {RpeUnit::kFrames, "f"}, {RpeUnit::kMeters, "m"}}};
}

struct RpeOptions {
  double delta = 1.0;  ///< in `unit`, > 0
  RpeUnit unit = RpeUnit::kSeconds;
  double offset_s = 0.0;  ///< added to the estimate's stamps when looking up the ground truth
};

struct RpeResult {
  Statistics translation_m;    ///< over delta; m/s for 1 s
  Statistics rotation_deg;     ///< over delta; deg/s for 1 s
  std::size_t self_pairs = 0;  ///< pairs with j = i: included by the tool, with zero error
  std::size_t dropped_gt = 0;  ///< pairs without ground truth within twice its median interval
};

/// RPE as defined above; t is the time, the index or the path length of a pose, depending on the unit. As in
/// the tool there is no limit on |t_j - (t_i + delta)|, and a pair is dropped if j is the last pose.
/// Alignment does not affect the result. Uses all pairs; the tool samples 10000 of them at random if there
/// are more.
/// @return nullopt if no pair is left
[[nodiscard]] std::optional<RpeResult> rpe(const Trajectory& gt, const Trajectory& est,
                                           const RpeOptions& options = {});

}  // namespace stillpoint::eval
