// SPDX-License-Identifier: BSD-3-Clause
/// What vision, depth and inertial data of a frame are worth, and the status that follows from it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/backend/health/bias_monitor.h"
#include "core/backend/health/depth_monitor.h"
#include "core/backend/health/inertial_checks.h"
#include "core/backend/health/inertial_interval.h"
#include "core/backend/health/inertial_noise.h"
#include "core/backend/health/moving_world.h"
#include "core/backend/health/tracking_monitor.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/config/imu_config.h"
#include "core/types/odometry_update.h"

namespace stillpoint {

/// What is expected of the newest frame before it is optimized.
struct Expectation {
  const NavState& before;                      ///< last reported state, with its biases
  const std::optional<UncertainPose>& camera;  ///< pose of the camera by reliable inertial data
  double residual_sigma;                       ///< of a bearing [normalized image plane]
  double white_sigma;                          ///< of its change between successive frames
};

/// Collects the evidence about a frame in the order of the functions below, and decides about its status
/// (TrackingMonitor). Wrong inertial data stays in the window with a noise so large that vision determines
/// the motion; its frames are marked unreliable. The window is changed in this respect, and wrong depths are
/// removed from it.
/// Inertial data between two frames.
struct InspectedInterval {
  std::span<const ImuSample> samples;
  Timestamp end;  ///< on the IMU clock
  ImuGap gap;
  bool inertial = false;  ///< whether the window is, see Window
};

class SensorMonitor {
 public:
  /// @param rig  with the configured noise of the IMU
  /// @param seed of the relocalization
  SensorMonitor(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed);

  /// @param bridged a repeated image for which constant velocity gives a pose with its covariance
  void begin_frame(const TrackedFrame& frame, bool bridged);

  /// See `TrackingMonitor::relocalize`, `relocated`, `map` and `awaits_map`.
  [[nodiscard]] std::optional<UncertainPose> relocalize(const TrackedFrame& frame, const Pose& T_w_c) {
    return tracking_.relocalize(frame, T_w_c);
  }
  void relocated() { tracking_.relocated(); }
  [[nodiscard]] const TrustedMap& map() const { return tracking_.map(); }
  [[nodiscard]] bool awaits_map() const { return tracking_.awaits_map(); }

  /// Inspects the samples up to a frame, before they enter the window. Where vision located the frame before,
  /// those after a gap in the stamps are doubted until they agree with it.
  /// @param interval samples and what they are of
  /// @return whether they are reliable
  [[nodiscard]] bool inspect(const InspectedInterval& interval);

  /// Noise, see InertialNoise, with which samples enter the window: so large for unreliable ones that vision
  /// determines the motion.
  [[nodiscard]] ImuNoise imu_noise(bool is_reliable) const {
    return is_reliable ? noise_.densities() : unreliable_noise(rig_.imu_noise);
  }

  /// Removes wrong depths of the newest frame, see DepthMonitor.
  void check_depth(const std::optional<StateCovariance>& covariance, Window& window) {
    depth_.update(covariance, window);
  }

  /// Before labels are derived from the predicted pose of the newest frame: recognizes inertial data that
  /// became wrong abruptly (StepCheck).
  void check_step(ImuBuffer& imu, Window& window);

  /// Compares the newest features with the expected pose (`reprojection_nis`).
  /// @return whether they are not where they were expected
  [[nodiscard]] bool has_unexpected_features(const Expectation& expected, const Window& window);

  /// Compares inertial data with the pose by vision alone (InertialCheck). Wrong data of the last frames is
  /// marked. Inertial data of a body at rest is not compared: disturbances do not look like rest, but a
  /// person who covers most of the image looks like a motion of the camera. Neither is a pose used that old
  /// points contradict.
  void check_inertial_data(const Expectation& expected, ImuBuffer& imu, Window& window);

  /// Follows the biases (BiasMonitor). After a step, their random walk in the samples that it was recognized
  /// by is enlarged, so that the solver follows it.
  void check_biases(ImuBuffer& imu, Window& window);

  /// Adds the uncertainty while sensors contradict each other. @param t stamp of the newest frame
  void add_contradiction(Timestamp t, StateCovariance& covariance) const {
    biases_.contradiction().add_to(covariance, t);
  }

  /// What the optimization of a frame has given.
  struct Outcome {
    bool located = true;  ///< inertial data or vision located it before the solve
    bool has_metric_scale = false;
    StatusReason failure = StatusReason::kNone;  ///< the window was cleared because of it
    const std::optional<StateCovariance>& covariance;
  };
  /// Whether the newest frame has the measured depths by which a window starts.
  [[nodiscard]] bool can_restart(const Window& window) const;

  /// Decides about the status of the frame.
  /// @return whether the window must be cleared
  [[nodiscard]] bool update_status(const Outcome& outcome, const Window& window);

  /// Why the estimate must be given up, if so: an implausible state, a world that moves (MovingWorld), or
  /// solves that failed in succession.
  [[nodiscard]] StatusReason failure_of(const Window& window, const NavState& before, int unusable_solves);

  /// After a change of the world frame, a restart of the window, and a restart with another calibration.
  void world_changed() { inertial_.reset(); }
  void window_restarted();
  void calibration_changed() { depth_.reset(); }

  [[nodiscard]] OdometryStatus status() const { return tracking_.status(); }
  [[nodiscard]] StatusReason reason() const { return tracking_.reason(); }
  /// Number of the current world frame.
  [[nodiscard]] int segment() const { return tracking_.segment(); }
  [[nodiscard]] bool trusts_imu() const { return inertial_.is_consistent(); }
  [[nodiscard]] const ImuNoiseFactors& imu_noise_factors() const { return noise_.factors(); }
  [[nodiscard]] const Innovations& innovations() const { return innovations_; }

 private:
  void assess_newest(const Window& window);
  /// Innovation of the camera pose by vision alone, of the frame at `t`.
  void compare_with_prediction(const Expectation& expected, const UncertainPose& visual, Timestamp t);
  /// By how much old points support the pose T_w_c by vision alone more than the predicted one, see
  /// `support`. If they support it less, the newer points, by which it was found, are on a person who came
  /// before the camera.
  [[nodiscard]] double added_support(const Window& window, const Pose& predicted, const Pose& T_w_c);
  void distrust_recent_samples(Window& window);
  void enlarge_bias_walk(const MeasuredBiases& measured, Window& window) const;

  BackendConfig backend_;
  ImuConfig imu_;
  Rig rig_;
  TrackingMonitor tracking_;
  SampleInspector inspector_;
  InertialNoise noise_;
  InertialCheck inertial_;
  StepCheck step_;
  BiasMonitor biases_;
  std::optional<MeasuredBiases> bias_step_;  ///< newest one, until inertial data is used again
  DepthMonitor depth_;
  MovingWorld moving_world_;
  FrameEvidence evidence_;   ///< of the last frame that was added
  Innovations innovations_;  ///< same
  // Members only to reuse the memory.
  std::vector<PointObservation> known_points_;
  std::vector<PointObservation> old_points_;
  std::vector<double> distances_;
};

}  // namespace stillpoint
