// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/imu_rate_poses.h"

#include <numbers>
#include <optional>

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

ImuRatePoses::ImuRatePoses(const OdometryConfig& config, std::span<const ImuSample> samples)
    : gravity_(config.imu.gravity), samples_(samples), predictor_(config.imu.max_gap_s) {
  motion_.uses_imu = config.imu.enabled;
  output_.trajectory.frame = "camera";
}

void ImuRatePoses::propagate_until(Timestamp end) {
  for (; next_ < samples_.size() && samples_[next_].t < end; ++next_) {
    predictor_.add_imu(samples_[next_]);
    const Timestamp t = after(samples_[next_].t, -motion_.time_offset_s);
    const std::optional<NavState> state = predictor_.state_at(t);
    std::vector<StampedPose>& poses = output_.trajectory.poses;
    // A time offset that increases by more than the interval of the samples would reverse the order.
    if (!state || (!poses.empty() && t <= poses.back().t)) continue;
    poses.push_back({t, state->T_w_b * motion_.T_b_c});
    output_.ages_ms.push_back(1e3 * seconds_between(motion_.newest.t, t));
  }
}

void ImuRatePoses::record_correction(const Pose& predicted_T_w_c, Timestamp sample) {
  const std::optional<NavState> state = predictor_.state_at(after(sample, -motion_.time_offset_s));
  if (!state) return;
  const Pose step = predicted_T_w_c.inverse() * (state->T_w_b * motion_.T_b_c);
  output_.corrections.push_back(
      {.translation_m = step.p.norm(),
       .rotation_deg = step.q.angularDistance(Eigen::Quaterniond::Identity()) * 180.0 / std::numbers::pi});
}

void ImuRatePoses::add(const OdometryUpdate& update, Timestamp available) {
  if (!motion_.uses_imu) return;
  propagate_until(available);
  std::optional<Pose> predicted;
  if (next_ > 0) {
    const std::optional<NavState> state =
        predictor_.state_at(after(samples_[next_ - 1].t, -motion_.time_offset_s));
    if (state) predicted = state->T_w_b * motion_.T_b_c;
  }
  const bool jumps = update.segment != segment_ || update.status == OdometryStatus::kRelocated;
  motion_.previous = motion_.initialized && !jumps ? motion_.newest : update.state;
  motion_.newest = update.state;
  segment_ = update.segment;
  motion_.T_b_c = update.state.T_w_b.inverse() * update.T_w_c;
  motion_.gravity_w = update.q_level_w.conjugate() * Eigen::Vector3d(0.0, 0.0, -gravity_);
  motion_.time_offset_s = update.time_offset_s;
  motion_.initialized = true;
  motion_.inertial = update.inertial;
  predictor_.set(motion_, update.status);
  if (predicted) record_correction(*predicted, samples_[next_ - 1].t);
}

}  // namespace stillpoint
