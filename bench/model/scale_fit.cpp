// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/scale_fit.h"

#include <cmath>

#include "eval/trajectory/alignment.h"
#include "eval/trajectory/association.h"

namespace stillpoint::bench {

double fit_scale(Trajectory& estimate, const Trajectory& truth) {
  const std::vector<eval::MatchedPose> matches =
      eval::matched_poses(truth, estimate, eval::associate_tum(truth, estimate));
  const double scale = eval::align(matches, eval::Alignment::kSim3).S_w_v.scale;
  if (matches.empty() || !(scale > 0.0) || !std::isfinite(scale)) return 1.0;
  for (StampedPose& pose : estimate.poses) pose.T_w_f.p *= scale;
  return scale;
}

void state_fitted_scale(std::vector<Metric>& metrics) {
  for (Metric& metric : metrics) {
    if (!metric.protocol.empty()) metric.protocol += kScaleFitted;
  }
}

}  // namespace stillpoint::bench
