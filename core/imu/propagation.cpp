// SPDX-License-Identifier: BSD-3-Clause
#include "core/imu/propagation.h"

namespace stillpoint {

NavState propagate(const NavState& start, std::span<const ImuSample> samples,
                   const Eigen::Vector3d& gravity_w) {
  const ImuBias bias{.gyro = start.gyro_bias, .accel = start.accel_bias};
  NavState state = start;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double dt = seconds_between(samples[i - 1].t, samples[i].t);
    const MidpointStep step = midpoint_step(state.T_w_b.q, samples[i - 1], samples[i], bias);
    const Eigen::Vector3d acceleration_w = step.force_r + gravity_w;
    state.t = samples[i].t;
    state.T_w_b.q = step.q_r_b;
    state.T_w_b.p += state.v_w * dt + 0.5 * dt * dt * acceleration_w;
    state.v_w += acceleration_w * dt;
  }
  return state;
}

MotionPrior rotation_prior(std::span<const ImuSample> samples, const Eigen::Vector3d& gyro_bias,
                           const Pose& T_b_c) {
  MotionPrior prior;
  if (samples.size() < 2) return prior;

  Eigen::Quaterniond q_bprev_bcur = Eigen::Quaterniond::Identity();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    q_bprev_bcur = q_bprev_bcur * exp_so3(midpoint_rotation(samples[i - 1], samples[i], gyro_bias));
  }
  prior.T_ccur_cprev.q = (T_b_c.q.conjugate() * q_bprev_bcur.conjugate() * T_b_c.q).normalized();
  prior.has_rotation = true;
  return prior;
}

MotionPrior full_prior(const Pose& T_w_bprev, const Pose& T_w_bcur, const Pose& T_b_c) {
  return {.T_ccur_cprev = (T_w_bcur * T_b_c).inverse() * (T_w_bprev * T_b_c),
          .has_rotation = true,
          .has_translation = true};
}

}  // namespace stillpoint
