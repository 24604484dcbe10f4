// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/bias_monitor.h"

#include <algorithm>
#include <cmath>

#include "core/config/monitor_config.h"

namespace stillpoint {
bool OffsetSettling::update(Timestamp t, double offset_s) {
  if (settled_) return true;
  if (!first_) first_ = t;
  while (estimates_.size() > 1 && seconds_between(estimates_[1].t, t) >= kMonitor.offset.interval_s) {
    estimates_.erase(estimates_.begin());
  }
  estimates_.push_back({t, offset_s});
  if (seconds_between(estimates_.front().t, t) < kMonitor.offset.interval_s) return false;
  const auto [least, greatest] = std::ranges::minmax(estimates_, {}, &Estimate::offset_s);
  settled_ = greatest.offset_s - least.offset_s < kMonitor.offset.change_s ||
             seconds_between(*first_, t) >= kMonitor.offset.max_s;
  return settled_;
}

void OffsetSettling::reset() {
  estimates_.clear();
  first_.reset();
  settled_ = false;
}

void Contradiction::begin_or_continue(const MeasuredBiases& measured, const NavState& state) {
  if (!holds_at(measured.t)) since_ = after(measured.t, -2.0 * kMonitor.bias.interval_s);
  checked_at_ = measured.t;
  accel_ = (measured.accel - state.accel_bias).norm();
  gyro_ = (measured.gyro - state.gyro_bias).norm();
}

bool Contradiction::holds_at(Timestamp t) const {
  return since_ && seconds_between(checked_at_, t) <= kMonitor.bias.contradiction_pause_s;
}

void Contradiction::add_to(StateCovariance& covariance, Timestamp t) const {
  if (!holds_at(t)) return;
  const double T = std::min(seconds_between(*since_, t), kMonitor.bias.contradiction_duration_s);
  covariance.state.diagonal().segment<3>(0).array() += std::pow(0.5 * accel_ * T * T, 2);
  covariance.state.diagonal().segment<3>(3).array() += std::pow(gyro_ * T, 2);
  covariance.state.diagonal().segment<3>(6).array() += std::pow(accel_ * T, 2);
}

BiasFindings BiasMonitor::update(const Window& window, ImuBuffer& imu) {
  using Result = BiasCheck::Result;
  const NavState& newest = window.frames.back().state;
  const Timestamp t = newest.t;
  const bool settled = offset_settling_.update(t, window.time_offset_s);
  const Result result = check_.update(window, imu);
  if (result == Result::kUnknown) return {};
  if (result == Result::kDiffers || result == Result::kDoubtful || (result == Result::kStep && !settled)) {
    contradiction_.begin_or_continue(check_.measured(), newest);
  } else {
    contradiction_.end();
  }
  if (result == Result::kDoubtful || !settled) return {};
  const bool agrees = result == Result::kAgrees;
  std::optional<Timestamp>& since = agrees ? agree_since_ : differ_since_;
  if (!since) since = t;
  (agrees ? differ_since_ : agree_since_).reset();
  return {.is_wrong = differ_since_ && seconds_between(*differ_since_, t) > kMonitor.bias.max_difference_s,
          .agrees = agree_since_ && seconds_between(*agree_since_, t) > kMonitor.bias.min_agreement_s,
          .has_step = result == Result::kStep};
}

void BiasMonitor::reset() {
  check_.reset();
  offset_settling_.reset();
  contradiction_.end();
  differ_since_.reset();
  agree_since_.reset();
}

}  // namespace stillpoint
