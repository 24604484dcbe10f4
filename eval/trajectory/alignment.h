// SPDX-License-Identifier: BSD-3-Clause
/// The transform that lays an estimate over its ground truth.
#pragma once

#include <span>

#include "eval/trajectory/association.h"

namespace stillpoint {

/// x_w = scale * R_w_v * x_v + p: world v of the estimate into world w of the ground truth.
struct Similarity {
  Pose T_w_v;
  double scale = 1.0;

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& x_v) const {
    return T_w_v.q * (scale * x_v) + T_w_v.p;
  }
  [[nodiscard]] Pose operator*(const Pose& T_v_f) const {
    return Pose{(T_w_v.q * T_v_f.q).normalized(), *this * T_v_f.p};
  }
};

/// A fitted transform, and whether the data determine all of it: a path along a line leaves the rotation
/// about the line open, a path that stands still leaves the whole rotation open.
struct AlignmentResult {
  Similarity S_w_v;
  bool determined = false;
};

/// Rigid least-squares fit of positions. Horn, J. Opt. Soc. Am. A 4, 1987, in the SVD form of Arun et al.,
/// IEEE PAMI 9, 1987, with Umeyama's sign rule (IEEE PAMI 13, 1991). Identity for no matches.
[[nodiscard]] AlignmentResult align_se3(std::span<const MatchedPose> matches);

}  // namespace stillpoint
