// SPDX-License-Identifier: BSD-3-Clause
/// Uncertainty of the motion between keyframes by the odometry. The motion between two successive keyframes
/// has the covariance
///
///   Q = diag(s_p^2 d + e_p^2, s_r^2 d + s_t^2 dt + e_r^2) + f^2 Q_window      (p + rho, q * Exp(theta))
///
/// The first part is a random walk over the distance d [m] and the time dt [s], of errors that the window
/// does not claim (calibration, depth, moving objects), with s_p = `loop.drift_m_per_sqrt_m`, s_r =
/// `loop.drift_deg_per_sqrt_m`, s_t = `loop.drift_deg_per_sqrt_s`, e_p = 2 mm, e_r = 0.02 degrees. Q_window
/// is composed of the covariances of the motion from the oldest frame of the window to the next one, see
/// `WindowSolver::covariance`; zero where it is not known (without `backend.covariance`, in a loaded map, at
/// the end of a run), and scaled down to at most 1 cm and 0.3 degrees: where people hide the scene the window
/// claims meters for a fifth of a second, along directions that a linear covariance does not describe, and
/// loops bent such motions. f = 3, as the published prior counts observations repeatedly. An error (rho,
/// theta) of the motion from k to k+1 moves all later poses by the displacement v + phi x p of the world with
///
///   phi = R_w,k+1 theta,   v = R_w,k rho - phi x p_k+1
///
/// so the covariances of (v, phi) add up, and that of the motion between any two keyframes follows from the
/// difference of two sums (Barfoot and Furgale 2014, Sec. III: uncertainty of compound poses, first order).
#pragma once

#include <optional>
#include <vector>

#include "core/config/loop_config.h"
#include "core/loop/keyframe.h"

namespace stillpoint {

class OdometryDrift {
 public:
  explicit OdometryDrift(const LoopConfig& config) : config_(config) {}

  /// Appends the next keyframe: its pose by the odometry.
  /// @param motion_covariance Q_window of the motion from the keyframe before; absent if it is not known
  void add(Timestamp t, const Pose& T_w_b, const std::optional<Matrix6>& motion_covariance = {});

  /// Appends the first keyframe of another run or segment, whose pose relative to the previous ones is
  /// unknown: Q has standard deviations of 1 km and 10 rad.
  void add_unrelated(Timestamp t, const Pose& T_w_b);

  /// Covariance Q of the motion from keyframe k - 1 to k, k > 0.
  [[nodiscard]] const Matrix6& step_covariance(std::size_t k) const { return steps_[k]; }

  /// Covariance of T_bi_bj, i < j: (p + rho, q * Exp(theta)).
  [[nodiscard]] Matrix6 covariance(std::size_t i, std::size_t j) const;

 private:
  [[nodiscard]] Matrix6 step(Timestamp t, const Pose& T_w_b,
                             const std::optional<Matrix6>& motion_covariance) const;
  void append(Timestamp t, const Pose& T_w_b, const Matrix6& step);

  LoopConfig config_;
  std::vector<Timestamp> times_;
  std::vector<Pose> T_w_b_;
  std::vector<Matrix6> steps_;  ///< Q of the motion to each keyframe; zero for keyframe 0
  std::vector<Matrix6> sums_;   ///< of (v, phi), from keyframe 0
};

}  // namespace stillpoint
