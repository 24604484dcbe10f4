// SPDX-License-Identifier: BSD-3-Clause
/// State optimization: computes a pose per frame from tracked features and inertial samples. Paper Sec. II.
#pragma once

#include "core/backend/dynamic_labeler.h"
#include "core/backend/health/sensor_monitor.h"
#include "core/backend/sliding_window.h"
#include "core/backend/start/calibration.h"
#include "core/backend/start/window_start.h"
#include "core/backend/state_prediction.h"
#include "core/types/odometry_update.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Sliding-window estimator. With depth it starts as metric visual odometry; with an IMU it switches to
/// visual-inertial odometry once gravity and velocities are initialized and reports poses from then on.
/// Without depth it only collects frames until structure from motion and the IMU determine the scale.
///
/// `process` is the order of a frame. What it consists of: `SlidingWindow` holds and optimizes the states,
/// `WindowStart` begins and initializes them, `Calibration` is what they start with, and `SensorMonitor`
/// decides which data is used and what the status is. The estimator itself holds the states that it reports.
class Estimator {
 public:
  /// @throws InputError see `WindowStart`
  Estimator(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed);

  /// Samples in temporal order; samples up to the exposure of a frame, by the time offset of `motion_state`,
  /// must be added before the frame, and up to 20 ms after it for `TimeOffsetModel::kInertial`.
  void add_imu(const ImuSample& sample) { imu_.add(sample); }

  /// Adds a frame to the window, optimizes the window including the pose of this frame, and slides it. A
  /// frame that neither vision nor inertial data locates is removed again; after a failure the window is
  /// cleared and restarts with the next frame.
  /// @param frame   features sorted by id
  /// @param dynamic which of them are excluded; null = none
  /// @return `update()`
  OdometryUpdate& process(const TrackedFrame& frame, DynamicLabeler* dynamic = nullptr);

  /// A frame that does not enter the window: its pose, propagated from the newest state. @return `update()`
  OdometryUpdate& predict(std::int64_t frame_id, Timestamp t);

  /// Result for the last frame that was processed or predicted. The caller may add timings, counters and
  /// hashes of other modules.
  [[nodiscard]] OdometryUpdate& update() { return update_; }

  /// Input of the tracker's motion prediction.
  [[nodiscard]] MotionState motion_state() const;

  [[nodiscard]] const ImuHealth& imu_health() const { return imu_.health(); }
  [[nodiscard]] const Window& window() const { return window_.states(); }

 private:
  // Steps of `process`, in its order.
  void begin_update(std::int64_t frame_id);
  void relocalize(const TrackedFrame& frame);
  void append(const TrackedFrame& frame);
  void preintegrate(WindowFrame& next);
  void label(DynamicLabeler::Labels labels) { mark_dynamic(labels, window_.states()); }
  void label_at_prediction(DynamicLabeler& dynamic);
  [[nodiscard]] bool refine();
  void slide();
  void free_calibration(Timestamp now);

  // Parts of `refine`.
  void check_data();
  void solve();
  void optimize();
  void converge_calibration(const AgreesWithRig& before);
  [[nodiscard]] bool accept_or_reset(const Eigen::Vector3d& gravity_before);
  void discard_newest();
  [[nodiscard]] bool update_status(bool located, StatusReason failure);

  [[nodiscard]] std::optional<UncertainPose> predicted_camera() const;
  [[nodiscard]] std::optional<UncertainPose> dead_reckoned_pose(Timestamp t);
  void restart(const Eigen::Vector3d& gravity_w);
  void restart_with_calibration(const Eigen::Vector3d& gyro_bias);
  void report(const NavState& state);

  bool uses_imu_;
  ImuBuffer imu_;
  Calibration calibration_;
  WindowStart start_;
  SlidingWindow window_;
  SensorMonitor monitor_;
  NavState newest_;                                   ///< last reported state
  NavState previous_;                                 ///< before it: constant velocity model without an IMU
  NavState bridged_;                                  ///< predicted at a repeated image
  std::optional<StateCovariance> newest_covariance_;  ///< of `newest_`, if it was computed
  bool calibration_found_ = false;                    ///< in this window, which has to start anew with it
  UncertainPose origin_;                              ///< pose of the body at which the window began
  OdometryUpdate update_;
};

}  // namespace stillpoint
