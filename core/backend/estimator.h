// SPDX-License-Identifier: BSD-3-Clause
/// The state optimisation: tracked features and inertial samples in, a pose per picture out. Paper Sec. II.
#pragma once

#include <cstdint>

#include "core/backend/backend_config.h"
#include "core/backend/window.h"
#include "core/backend/window_solver.h"
#include "core/imu/imu_buffer.h"
#include "core/imu/imu_config.h"
#include "core/types/motion_prior.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// A sliding window over the last pictures. It starts as visual odometry of metric scale; with an IMU it
/// turns inertial as soon as gravity and speeds are known, and reports poses from then on.
class Estimator {
 public:
  /// @throws InputError if depth is off (no scale) or inertial data are asked of a rig without an IMU
  Estimator(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed);

  /// Samples in order of time; those up to a picture's exposure come before the picture.
  void add_imu(const ImuSample& sample) { imu_.add(sample); }

  /// How the camera moved between two pictures, for the tracker; the newest state is not after `from`.
  /// Inertial data only: a tracker that starts where constant velocity puts weak features finds them there,
  /// and the estimate follows itself.
  [[nodiscard]] MotionPrior motion_prior(Timestamp from, Timestamp to);

  /// Takes a picture into the window and refines it.
  [[nodiscard]] OdometryUpdate process(const TrackedFrame& frame);

  /// The pose at a picture that does not enter the window, propagated from the newest state.
  [[nodiscard]] OdometryUpdate predict(std::int64_t frame_id, Timestamp t);

  [[nodiscard]] const ImuHealth& imu_health() const { return imu_.health(); }
  [[nodiscard]] const Window& window() const { return window_; }

 private:
  [[nodiscard]] bool uses_imu() const { return imu_config_.enabled; }
  [[nodiscard]] bool is_full() const { return window_.newest() == backend_.window_size; }
  [[nodiscard]] NavState extrapolate(Timestamp t);
  void push_frame(const TrackedFrame& frame);
  [[nodiscard]] bool locate_newest();
  void refresh_preintegrations();
  void try_to_become_inertial();
  [[nodiscard]] bool has_failed(const NavState& before) const;
  void restart();
  void slide(bool keyframe);
  [[nodiscard]] OdometryStatus status() const;

  BackendConfig backend_;
  ImuConfig imu_config_;
  Rig rig_;
  std::uint32_t seed_;
  ImuBuffer imu_;
  Window window_;
  NavState newest_;    ///< last state handed out
  NavState previous_;  ///< the one before: constant velocity where there is no IMU
  bool located_ = true;
};

}  // namespace stillpoint
