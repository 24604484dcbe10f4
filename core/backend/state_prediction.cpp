// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/state_prediction.h"

#include "core/geometry/so3.h"
#include "core/imu/propagation.h"

namespace stillpoint {
namespace {

/// The time offset may still change by so much.
constexpr double kKeptBefore_s = 0.2;

Pose constant_velocity(const NavState& previous, const NavState& newest, Timestamp t) {
  const double share = seconds_between(newest.t, t) / seconds_between(previous.t, newest.t);
  const Pose step = previous.T_w_b.inverse() * newest.T_w_b;
  return newest.T_w_b * Pose{exp_so3(share * log_so3(step.q)), share * step.p};
}

}  // namespace

NavState extrapolate(const MotionKnowledge& known, ImuBuffer& imu, Timestamp t) {
  NavState state = known.newest;
  if (t == known.newest.t) return state;
  if (known.inertial) {
    NavState start = known.newest;
    start.t = after(start.t, known.time_offset_s);
    state = propagate(start, imu.samples_up_to(start.t, after(t, known.time_offset_s)), known.gravity_w);
  } else if (known.previous.t < known.newest.t) {
    state.T_w_b = constant_velocity(known.previous, known.newest, t);
  }
  state.t = t;
  return state;
}

void forget_spent(const MotionKnowledge& known, ImuBuffer& imu) {
  if (known.begun) imu.forget_before(after(known.newest.t, known.time_offset_s - kKeptBefore_s));
}

MotionPrior motion_prior(const MotionKnowledge& known, ImuBuffer& imu, Timestamp from, Timestamp to) {
  if (!known.begun || !known.uses_imu) return {};
  if (known.inertial) {
    return full_prior(extrapolate(known, imu, from).T_w_b, extrapolate(known, imu, to).T_w_b, known.T_b_c);
  }
  return rotation_prior(imu.samples_up_to(after(from, known.time_offset_s), after(to, known.time_offset_s)),
                        known.newest.gyro_bias, known.T_b_c);
}

}  // namespace stillpoint
