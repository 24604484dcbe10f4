// SPDX-License-Identifier: BSD-3-Clause
/// The poses that a run without an error would claim.
#pragma once

#include <vector>

#include "core/geometry/so3.h"
#include "core/types/trajectory.h"
#include "eval/metrics/consistency.h"

namespace stillpoint::test {

/// The poses of `gt` in a rotated and displaced world, each located, with the sigmas and covariances of
/// `claimed`.
inline std::vector<eval::ClaimedPose> located_claims(const Trajectory& gt, eval::ClaimedPose claimed) {
  const Pose T_v_w{exp_so3({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0}};
  claimed.claim = eval::PoseClaim::kLocated;
  std::vector<eval::ClaimedPose> claims;
  for (const StampedPose& pose : gt.poses) {
    claimed.t = pose.t;
    claimed.T_w_c = T_v_w * pose.T_w_f;
    claims.push_back(claimed);
  }
  return claims;
}

}  // namespace stillpoint::test
