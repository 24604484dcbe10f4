// SPDX-License-Identifier: BSD-3-Clause
/// Hand-eye calibration of an estimate and its ground truth whose body frames differ by an unknown rigid
/// transform, and whose clocks differ by a constant offset:
///
///   G(t + offset) = T_w_v E(t) T_f_g
///
/// G: ground-truth pose of body g in world w; E: estimated pose of body f in world v. For a given offset,
/// rotations come first, from relative motions over 0.5 s, whose rotation vectors satisfy
/// log(E_ij) = R_f_g log(G_ij) (Park and Martin, IEEE T-RA 10, 1994), then R_w_v as the mean of
/// R(G_i) (R(E_i) R_f_g)^T, then both translations by linear least squares over
///
///   p(G_i) = R_w_v (R(E_i) p_f_g + p(E_i)) + p_w_v
///
/// The offset minimizes the RMSE of these positions plus that of the rotations times the extent of the path
/// (its standard deviation), by golden-section search.
#pragma once

#include <string>

#include "core/types/trajectory.h"

namespace stillpoint::eval {

struct HandEye {
  Pose T_f_g;             ///< pose of the ground truth's body in that of the estimate
  double offset_s = 0.0;  ///< to be added to the stamps of the estimate
  double position_rmse_m = 0.0;
  double rotation_rmse_deg = 0.0;
  std::string undetermined;  ///< why the motion does not determine it; empty if it does
};

/// Solves for body transform and offset. Offsets are searched within 0.5 s.
/// @param gt ground truth; interpolated between neighbors less than 0.11 s away
/// @param est estimate
[[nodiscard]] HandEye hand_eye(const Trajectory& gt, const Trajectory& est);

}  // namespace stillpoint::eval
