// SPDX-License-Identifier: BSD-3-Clause
/// State at IMU rate: propagates the newest estimated state with all samples received so far. Paper Sec. II.
#pragma once

#include <optional>

#include "core/backend/state_prediction.h"
#include "core/types/odometry_update.h"

namespace stillpoint {

class StatePredictor {
 public:
  /// @param max_gap_s time for which the newest sample is held
  explicit StatePredictor(double max_gap_s) : imu_(max_gap_s) {}

  void add_imu(const ImuSample& sample) { imu_.add(sample); }

  /// Sets the estimate after a frame.
  void set(const MotionState& motion, OdometryStatus status);

  /// As `Odometry::state`.
  [[nodiscard]] std::optional<NavState> state() const;
  /// As `Odometry::state_at`.
  [[nodiscard]] std::optional<NavState> state_at(Timestamp t);

 private:
  ImuBuffer imu_;
  MotionState motion_;
  bool valid_ = false;
};

}  // namespace stillpoint
