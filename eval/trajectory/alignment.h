// SPDX-License-Identifier: BSD-3-Clause
/// The transform that lays an estimate over its ground truth.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "core/base/fields.h"
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

enum class Alignment {
  kNone,       ///< the worlds are taken as one
  kFirstPose,  ///< the first matched poses fall together
  kYaw,        ///< position and the angle about z: what an odometry that knows gravity leaves open
  kSe3,        ///< position and rotation
  kSim3,       ///< and scale
};
constexpr auto enum_names(Alignment) {
  return EnumNames<Alignment, 5>{{{Alignment::kNone, "none"},
                                  {Alignment::kFirstPose, "first_pose"},
                                  {Alignment::kYaw, "yaw"},
                                  {Alignment::kSe3, "se3"},
                                  {Alignment::kSim3, "sim3"}}};
}

/// A fitted transform, and whether the data determine all of it: a path along a line leaves the rotation
/// about the line open, a path that stands still leaves the whole rotation open.
struct AlignmentResult {
  Similarity S_w_v;
  bool determined = false;
};

/// Least-squares fit over positions; se3 and sim3 after Horn, J. Opt. Soc. Am. A 4, 1987, and Umeyama, IEEE
/// PAMI 13, 1991. Identity for no matches.
/// @param first_n fit over the first n matches only; 0 = all
[[nodiscard]] AlignmentResult align(std::span<const MatchedPose> matches, Alignment kind,
                                    std::size_t first_n = 0);

/// `align`, where an alignment that the data leave open is an error.
/// @throws InputError if the fit is not determined; `place` names the estimate in the message
[[nodiscard]] AlignmentResult align_or_throw(std::span<const MatchedPose> matches, Alignment kind,
                                             std::size_t first_n, const std::string& place);

}  // namespace stillpoint
