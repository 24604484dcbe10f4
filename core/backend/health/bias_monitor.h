// SPDX-License-Identifier: BSD-3-Clause
/// What follows from a check of the biases: convergence of the time offset after a start, and the uncertainty
/// of a pose while inertial data and vision contradict each other.
#pragma once

#include <optional>
#include <vector>

#include "core/backend/health/inertial_checks.h"
#include "core/base/timestamp.h"
#include "core/types/nav_state.h"

namespace stillpoint {

/// A time offset that is wrong by dt makes inertial data differ from vision by the angular acceleration times
/// dt, which looks like wrong biases. The covariance does not tell when that has ended: it is that of a
/// linearization, and claims 0.5 ms while an estimate is still 35 ms off. The estimate itself tells, as it
/// moves on. It has settled when it changed by less than 1.5 ms in 0.5 s, at the latest after 3 s, and counts
/// as settled from then on: a sensor that becomes wrong later moves it, too.
class OffsetSettling {
 public:
  /// @param t of a frame, later than the last one
  /// @param offset_s estimate [s]
  /// @return whether the estimate has settled
  bool update(Timestamp t, double offset_s);

  /// After a restart with the time offset of the rig.
  void reset();

 private:
  struct Estimate {
    Timestamp t;
    double offset_s;
  };
  std::vector<Estimate> estimates_;  ///< of the last 0.5 s, and the newest one before
  std::optional<Timestamp> first_;
  bool settled_ = false;
};

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

/// What the last checks of the biases say about the inertial data.
struct BiasFindings {
  bool is_wrong = false;  ///< its errors persist and are not those of a bias
  bool agrees = false;    ///< it has agreed for some time
  bool has_step = false;  ///< a bias has made a step, see `BiasMonitor::measured`
};

/// Follows the biases by BiasCheck. Errors that persist for 1 s are not those of a bias: the data is not used
/// until they have been absent for 0.7 s. While the time offset converges, errors are its own: the solver
/// needs the data, and only the uncertainty grows.
class BiasMonitor {
 public:
  explicit BiasMonitor(double focal_px) : check_(focal_px) {}

  /// Processes the newest frame of an inertial window with inertial data.
  [[nodiscard]] BiasFindings update(const Window& window, ImuBuffer& imu);

  [[nodiscard]] const MeasuredBiases& measured() const { return check_.measured(); }
  [[nodiscard]] const Contradiction& contradiction() const { return contradiction_; }

  /// After a restart of the window.
  void reset();

 private:
  BiasCheck check_;
  OffsetSettling offset_settling_;
  Contradiction contradiction_;
  std::optional<Timestamp> differ_since_;  ///< by successive checks
  std::optional<Timestamp> agree_since_;   ///< same
};

}  // namespace stillpoint
