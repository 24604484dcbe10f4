// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/state_predictor.h"

namespace stillpoint {

void StatePredictor::set(const MotionState& motion, OdometryStatus status) {
  motion_ = motion;
  valid_ = is_located(status) || status == OdometryStatus::kDeadReckoning;
  drop_old_samples(motion_, imu_);
}

std::optional<NavState> StatePredictor::state() const {
  if (!valid_) return std::nullopt;
  return motion_.newest;
}

std::optional<NavState> StatePredictor::state_at(Timestamp t) {
  if (!valid_ || t < motion_.newest.t) return std::nullopt;
  if (motion_.inertial && t > motion_.newest.t) {
    const Timestamp begin = after(motion_.newest.t, motion_.time_offset_s);
    if (imu_.samples_up_to(begin, after(t, motion_.time_offset_s)).empty()) return std::nullopt;
  }
  return extrapolate(motion_, imu_, t);
}

}  // namespace stillpoint
