// SPDX-License-Identifier: BSD-3-Clause
/// State optimization: computes a pose per frame from tracked features and inertial samples. Paper Sec. II.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/backend/health/bias_check.h"
#include "core/backend/health/camera_rotations.h"
#include "core/backend/health/contradiction.h"
#include "core/backend/health/depth_scale.h"
#include "core/backend/health/inertial_check.h"
#include "core/backend/health/inertial_interval.h"
#include "core/backend/health/offset_settling.h"
#include "core/backend/health/step_check.h"
#include "core/backend/health/tracking_monitor.h"
#include "core/backend/marginalization/frame_marginalizer.h"
#include "core/backend/solvers/window_solver.h"
#include "core/backend/start/camera_pose.h"
#include "core/backend/start/rotation_alignment.h"
#include "core/backend/state_prediction.h"
#include "core/backend/window/pixel_noise.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/config/imu_config.h"
#include "core/geometry/covariance.h"
#include "core/imu/imu_buffer.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"
#include "core/types/tracked_frame.h"

namespace stillpoint {

/// Ratio of measured to true depth.
struct DepthScaleEstimate {
  double value = 1.0;
  double sigma = 0.0;  ///< standard deviation
};

/// Sliding-window estimator. With depth it starts as metric visual odometry; with an IMU it switches to
/// visual-inertial odometry once gravity and velocities are initialized and reports poses from then on.
/// Without depth it only collects frames until structure from motion and the IMU determine the scale.
class Estimator {
 public:
  /// @throws InputError if the IMU is enabled for a rig without one, or if the scale is unobservable: depth
  /// is off and there is no IMU or no monocular initializer
  Estimator(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed);

  /// Samples in temporal order; samples up to the exposure of a frame, by the time offset of `motion_state`,
  /// must be added before the frame, and up to 20 ms after it for `TimeOffsetModel::kInertial`.
  void add_imu(const ImuSample& sample) { imu_.add(sample); }

  /// Appends a frame to the window at its predicted pose.
  ///
  /// Call order per frame: `add`, `mark_dynamic` (labels from detections), `refine`, `mark_dynamic` (labels
  /// from the moving consistency check with the refined poses), `finish`. `add` resets `update()`, and each
  /// step fills its part of it.
  /// @param frame features sorted by id
  void add(const TrackedFrame& frame);

  /// Excludes dynamic landmarks from the estimate and re-admits cleared ones.
  /// @param labels sorted by id; landmarks without a label are unchanged
  void mark_dynamic(std::span<const DynamicLabel> labels);

  /// Before labels are derived from the predicted pose of the newest frame: recognizes inertial data that
  /// became wrong abruptly (StepCheck). Vision then determines the pose, and `has_inertial_prediction` is
  /// false.
  void check_prediction();

  /// Camera pose of the newest frame as predicted by inertial data, with its covariance relative to the frame
  /// before, which the optimization claims; absent without reliable data, or if no covariance is known.
  [[nodiscard]] std::optional<UncertainPose> predicted_camera() const;

  /// Optimizes the window, including the pose of the newest frame.
  /// A frame that neither vision nor inertial data locates is removed again.
  /// @return false after a failure: the window has been cleared and restarts with the next frame
  [[nodiscard]] bool refine();

  /// Slides the window (marginalization) and reports the state.
  void finish();

  /// Resets `update()` to a frame that does not enter the window: its pose, propagated from the newest state.
  void predict(std::int64_t frame_id, Timestamp t);

  /// Result for the last frame that was added or predicted. The caller may add timings, counters and hashes
  /// of other modules.
  [[nodiscard]] OdometryUpdate& update() { return update_; }

  /// Input of the tracker's motion prediction.
  [[nodiscard]] MotionState motion_state() const;

  /// Whether the newest frame was predicted by reliable inertial data.
  [[nodiscard]] bool has_inertial_prediction() const {
    return window_.inertial && !window_.frames.empty() && window_.frames.back().imu_is_reliable;
  }

  [[nodiscard]] const ImuHealth& imu_health() const { return imu_.health(); }
  [[nodiscard]] const Window& window() const { return window_; }

  /// After `refine`, if the oldest frame leaves the window in `finish`: its motion to the next frame, with
  /// the covariance of the last solve; absent unless `backend.covariance` is on.
  [[nodiscard]] const std::optional<UncertainPose>& oldest_motion() const { return oldest_motion_; }

 private:
  [[nodiscard]] bool uses_imu() const { return imu_config_.enabled; }
  [[nodiscard]] bool has_metric_scale() const {
    return window_.inertial || backend_.depth.usage != DepthUsage::kOff;
  }
  /// Whether the calibration is observed by inertial data at the exposures.
  [[nodiscard]] bool averages_imu() const {
    return backend_.time_offset_model == TimeOffsetModel::kInertial ||
           backend_.prior == PriorModel::kConsistent;
  }
  [[nodiscard]] bool is_full() const { return window_.newest() == backend_.window_size; }
  void relocalize(const TrackedFrame& frame);
  [[nodiscard]] std::optional<UncertainPose> dead_reckoned_pose(Timestamp t);
  [[nodiscard]] Window calibrated_window() const;
  [[nodiscard]] bool agrees_with_rig(double contradiction, int degrees_of_freedom) const;
  [[nodiscard]] bool agrees_with_rig(const RotationAlignment& alignment) const;
  void compare_with_rig(const RigContradiction& contradiction);
  [[nodiscard]] LinearPrior prior_of_calibration() const;
  void begin_window(WindowFrame first);
  void push_frame(const TrackedFrame& frame);
  [[nodiscard]] bool knows_depth_scale() const;
  void reject_depth_of_another_scale();
  void integrate_samples(const WindowFrame& last, WindowFrame& next);
  [[nodiscard]] bool localize_newest();
  void check_inertial_data();
  [[nodiscard]] double residual_sigma() const;
  void record_reprojection_nis();
  void record_inertial_nis(const Pose& T_w_c, double inlier_scale);
  void distrust_recent_samples();
  void check_biases();
  void enlarge_bias_walk(const MeasuredBiases& measured);
  void solve();
  void compute_covariance();
  void discard_newest();
  [[nodiscard]] StatusReason failure() const;
  [[nodiscard]] bool update_status();
  void assess_newest();
  void repropagate_preintegrations();
  void try_initialize_imu();
  [[nodiscard]] bool aligns_rotations() const;
  void free_calibration();
  void align_rotations();
  void restart_with_calibration(const Eigen::Vector3d& gyro_bias);
  void restart(const Eigen::Vector3d& gravity_w);
  void forget_biases();
  void slide(bool keyframe);
  void begin_update(std::int64_t frame_id);
  void report(const NavState& state);

  BackendConfig backend_;
  ImuConfig imu_config_;
  Rig rig_;
  std::uint32_t seed_;
  ImuBuffer imu_;
  std::unique_ptr<WindowSolver> solver_;
  CameraRotations camera_rotations_;
  RotationAligner rotation_aligner_;
  std::optional<RotationAlignment> rotation_alignment_;  ///< found at the start
  std::optional<DepthScaleEstimate> depth_scale_found_;  ///< contradicts the rig
  FrameMarginalizer marginalizer_;                       ///< buffers only
  LinearPrior discarded_prior_;                          ///< its memory is reused
  Window window_;
  std::vector<PointObservation> known_points_;  ///< buffer of `localize_newest`
  std::vector<double> distances_;               ///< buffer of `reprojection_nis`
  ReprojectionErrorMonitor error_monitor_;
  PixelNoise pixel_noise_;
  NavState newest_;        ///< last reported state
  NavState previous_;      ///< the state before it: constant velocity model without an IMU
  bool localized_ = true;  ///< whether the pose of the newest frame was found
  bool keyframe_ = true;   ///< whether the second-newest frame stays in the window
  TrackingMonitor monitor_;
  SampleInspector inspector_;
  InertialCheck inertial_check_;
  StepCheck step_check_;
  BiasCheck bias_check_;
  OffsetSettling offset_settling_;
  Contradiction contradiction_;                   ///< of the sensors, by the checks of the biases
  std::optional<Timestamp> biases_differ_since_;  ///< by successive checks of the biases
  std::optional<Timestamp> biases_agree_since_;   ///< same
  DepthScale depth_scale_;
  std::optional<Timestamp> depth_rejected_since_;
  NavState bridged_;                                  ///< predicted at a repeated image
  std::optional<StateCovariance> newest_covariance_;  ///< of `newest_`, if it was computed
  std::optional<UncertainPose> oldest_motion_;
  FrameEvidence evidence_;   ///< of the last frame that was added
  int unusable_solves_ = 0;  ///< in succession
  OdometryUpdate update_;
};

}  // namespace stillpoint
