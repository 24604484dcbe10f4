// SPDX-License-Identifier: BSD-3-Clause
/// Uncertainty of a pose while inertial data and vision contradict each other.
#pragma once

#include <optional>

#include "core/backend/health/bias_check.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// Before it is known which of two sensors is wrong, the estimate is between both. With the errors a of the
/// accelerometer and w of the gyroscope that explain their difference, present for the time T, one of them
/// is off by a T^2 / 2, a T and w T; the variances of position, velocity and rotation grow by the squares.
/// T is at most 1 s, after which certain vision prevails.
class Contradiction {
 public:
  /// A check of the biases found a difference that is not that of a step. The measurement began 0.48 s ago.
  void begin_or_continue(const MeasuredBiases& measured, const NavState& state);
  void end() { since_.reset(); }

  /// Until 0.3 s after the last check that found it.
  /// @param t on the clock of the IMU
  [[nodiscard]] bool holds_at(Timestamp t) const;

  /// Adds the variances at `t`, while the contradiction holds.
  void add_to(StateCovariance& covariance, Timestamp t) const;

 private:
  std::optional<Timestamp> since_;
  Timestamp checked_at_;
  double accel_ = 0.0;  ///< [m/s^2]
  double gyro_ = 0.0;   ///< [rad/s]
};

}  // namespace stillpoint
