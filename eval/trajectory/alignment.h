// SPDX-License-Identifier: BSD-3-Clause
/// Alignment of an estimate to its ground truth by least squares over the positions, and change of the body
/// frame:
///
///   (s, R, t) = argmin sum_i |g_i - (s R e_i + t)|^2
///
/// g_i, e_i: positions of ground truth and estimate, with means g~ and e~. Solution of Umeyama, IEEE PAMI 13,
/// 1991, Eqs. 34-43 (for s = 1 also Horn, J. Opt. Soc. Am. A 4, 1987):
///
///   C = 1/n sum_i (g_i - g~)(e_i - e~)^T = U D V^T          (singular value decomposition)
///   R = U S V^T,  S = diag(1, 1, sign(det U det V))
///   s = trace(D S) / sigma_e^2,  sigma_e^2 = 1/n sum_i |e_i - e~|^2   (s = 1 for SE(3))
///   t = g~ - s R e~
///
/// Yaw only (`posyaw` of rpg_trajectory_evaluation and ov_eval): R = Rz(a) with
/// a = atan2(C_10 - C_01, C_00 + C_11), which maximizes trace(Rz(a) C^T).
#pragma once

#include <cstddef>
#include <string_view>

#include "core/base/fields.h"
#include "eval/trajectory/pose_matches.h"

namespace stillpoint::eval {

enum class Alignment {
  kNone,       ///< identity
  kFirstPose,  ///< makes the first matched poses equal
  kYaw,        ///< translation and yaw: the unobservable directions of visual-inertial odometry
  kSe3,        ///< translation and rotation
  kSim3,       ///< translation, rotation and scale
};
constexpr auto enum_names(Alignment) {
  return EnumNames<Alignment, 5>{{{Alignment::kNone, "none"},
                                  {Alignment::kFirstPose, "first_pose"},
                                  {Alignment::kYaw, "yaw"},
                                  {Alignment::kSe3, "se3"},
                                  {Alignment::kSim3, "sim3"}}};
}

/// A fitted transform, and whether the positions determine it uniquely: if they are collinear, the rotation
/// about the line is undetermined; if they coincide, the whole rotation is.
struct AlignmentResult {
  Similarity S_w_v;
  bool determined = false;
};

/// Alignment as defined above; identity without matches.
/// @param matches positions e_i and g_i
/// @param kind which of s, R and t are estimated
/// @param first_n use the first n matches only; 0 = all
[[nodiscard]] AlignmentResult align(MatchView matches, Alignment kind, std::size_t first_n = 0);

/// Change of the body frame: T_w_g = T_w_f T_f_g for every pose; f and g are rigidly connected.
/// @param trajectory poses T_w_f
/// @param T_f_g pose of frame g in frame f
/// @param name of frame g
[[nodiscard]] Trajectory move_to_frame(const Trajectory& trajectory, const Pose& T_f_g,
                                       const std::string& name);

}  // namespace stillpoint::eval
