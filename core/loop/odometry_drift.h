// SPDX-License-Identifier: BSD-3-Clause
/// Uncertainty of the motion between keyframes by the odometry: a random walk over distance and time.
///
/// The motion between two successive keyframes, over the distance d [m] and the time dt [s], has the
/// covariance
///
///   Q = diag(s_p^2 d + e_p^2, s_r^2 d + s_t^2 dt + e_r^2)      (p + rho, q * Exp(theta))
///
/// with s_p = `loop.drift_m_per_sqrt_m`, s_r = `loop.drift_deg_per_sqrt_m`, s_t =
/// `loop.drift_deg_per_sqrt_s`, e_p = 2 mm, e_r = 0.02 degrees. An error (rho, theta) of the motion from k to
/// k+1 moves all later poses by the displacement v + phi x p of the world with
///
///   phi = R_w,k+1 theta,   v = R_w,k rho - phi x p_k+1
///
/// so the covariances of (v, phi) add up, and that of the motion between any two keyframes follows from the
/// difference of two sums (Barfoot and Furgale 2014, Sec. III: uncertainty of compound poses, first order).
#pragma once

#include <vector>

#include "core/config/loop_config.h"
#include "core/loop/keyframe.h"

namespace stillpoint {

class OdometryDrift {
 public:
  explicit OdometryDrift(const LoopConfig& config) : config_(config) {}

  /// Appends the next keyframe: its pose by the odometry.
  void add(Timestamp t, const Pose& T_w_b);

  /// Appends the first keyframe of another run, whose pose relative to the previous ones is unknown: Q has
  /// standard deviations of 1 km and 10 rad.
  void add_unrelated(Timestamp t, const Pose& T_w_b);

  /// Covariance Q of the motion from keyframe k - 1 to k, k > 0.
  [[nodiscard]] Matrix6 step_covariance(std::size_t k) const;

  /// Covariance of T_bi_bj, i < j: (p + rho, q * Exp(theta)).
  [[nodiscard]] Matrix6 covariance(std::size_t i, std::size_t j) const;

 private:
  LoopConfig config_;
  std::vector<Timestamp> times_;
  std::vector<Pose> T_w_b_;
  std::vector<Matrix6> sums_;  ///< of (v, phi), from keyframe 0
  std::size_t unrelated_ = 0;  ///< keyframe of `add_unrelated`; 0: none
};

}  // namespace stillpoint
