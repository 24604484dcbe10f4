// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/contradiction.h"

#include <algorithm>
#include <cmath>

namespace stillpoint {
namespace {

constexpr double kMeasured_s = 0.48;
constexpr double kMaxPause_s = 0.3;
constexpr double kMaxDuration_s = 1.0;

}  // namespace

void Contradiction::begin_or_continue(const MeasuredBiases& measured, const NavState& state) {
  if (!holds_at(measured.t)) since_ = after(measured.t, -kMeasured_s);
  checked_at_ = measured.t;
  accel_ = (measured.accel - state.accel_bias).norm();
  gyro_ = (measured.gyro - state.gyro_bias).norm();
}

bool Contradiction::holds_at(Timestamp t) const {
  return since_ && seconds_between(checked_at_, t) <= kMaxPause_s;
}

void Contradiction::add_to(StateCovariance& covariance, Timestamp t) const {
  if (!holds_at(t)) return;
  const double T = std::min(seconds_between(*since_, t), kMaxDuration_s);
  covariance.state.diagonal().segment<3>(0).array() += std::pow(0.5 * accel_ * T * T, 2);
  covariance.state.diagonal().segment<3>(3).array() += std::pow(gyro_ * T, 2);
  covariance.state.diagonal().segment<3>(6).array() += std::pow(accel_ * T, 2);
}

}  // namespace stillpoint
