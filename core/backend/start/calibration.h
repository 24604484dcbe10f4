// SPDX-License-Identifier: BSD-3-Clause
/// Online calibration: time offset, camera pose on the body, depth scale.
#pragma once

#include <optional>

#include "core/backend/solvers/window_solver.h"
#include "core/backend/start/rotation_alignment.h"
#include "core/backend/window/window.h"
#include "core/config/backend_config.h"
#include "core/imu/imu_buffer.h"
#include "core/types/odometry_update.h"

namespace stillpoint {

/// The calibration that a window starts with, and whether it is that of the rig. Estimated extrinsics,
/// depth scale and lens have the values of the rig until the data contradicts those with
/// `calibration_agreement_probability`, or 99 % of depth scale and lens. Then a window starts with what was
/// found so far: rotation and time offset by a RotationAlignment, extrinsics, depth scale and lens by the
/// window before. Extrinsics that the configuration keeps constant become variable, too, when a certain
/// alignment contradicts them.
class Calibration {
 public:
  Calibration(const BackendConfig& config, bool uses_imu, const Rig& rig);

  /// Without frames, with the calibration that `prior` is about.
  [[nodiscard]] Window calibrated_window() const;

  /// About the rig. A depth scale or lens that was found is known by the residuals of windows that are given
  /// up, and rotation and time offset, if they contradict the rig, by the rotations that they were aligned
  /// with.
  [[nodiscard]] LinearPrior prior() const;

  /// Whether rotation and time offset are to be aligned at the start, and are not yet. The features need
  /// measured depth, by which the window can also start anew without an IMU.
  [[nodiscard]] bool awaits_alignment() const;

  /// The start of a window is doubted again, see `compare_with_rig`, and its prior is what was known before.
  void window_restarted();

  /// One of the time offset alone comes before that of the rotation.
  /// @return whether it contradicts the rig: windows start with it from now on
  [[nodiscard]] bool align(const RotationAlignment& alignment);

  /// What the alignment says about the rig; absent before it.
  [[nodiscard]] std::optional<AlignedRotation> aligned_rotation() const;

  /// Compares the rig with the residuals of the last solve.
  ///
  /// The inverse depth scale k differs from 1 by d, that of its value and of the Gauss-Newton step that is
  /// left: while k is constant, the step of the score test. With its variance C, s_a the scale error of the
  /// accelerometer, and t the time since the first comparison in the window,
  ///
  ///   d^2 / (C (1 + (t_n / t)^2) + s_a^2)
  ///
  /// is compared with 6.63, the 99 % quantile of one degree of freedom: s_a and the term with t_n = 1.5 s,
  /// which doubts the inertial noise of the start, contain what a true scale seems to be off by. Below 4
  /// (without that term) the scale is that of the rig again: the prior of the window holds for any. It is
  /// that of the rig as well where C is more than a quarter of its prior variance.
  /// The lens likewise, with what a calibration leaves in place of s_a, 13.28 (99 % of four degrees of
  /// freedom) in place of 6.63, and from the start. Its center and the extrinsics are compared after the
  /// rotations were aligned, since before it is not known which value is wrong; extrinsics that were found to
  /// contradict the rig stay variable.
  /// @param step of the last solve
  /// @param covariance of its newest state
  /// @param window calibration that contradicts the rig becomes variable in it
  void compare_with_rig(const RigStep& step, const StateCovariance& covariance, Window& window);

  /// Moves the calibration of a window back into its bounds around the values of the rig: the time offset and
  /// the depth scale are clamped, the translation and the rotation vector of the extrinsics relative to the
  /// rig are shortened. An estimate outside of them is implausible, and IMU samples are only provided up to
  /// the bound of the time offset (see `last_imu_end_of`).
  /// @return which values were at their bound
  CalibrationAtBound limit(Window& window) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = StateCovariance::Matrix6;
  struct DepthScaleEstimate {
    double value = 1.0;  ///< ratio of measured to true depth
    double sigma = 0.0;  ///< standard deviation of its inverse
  };
  struct LensEstimate {
    Eigen::Vector4d value;
    Eigen::Matrix4d covariance;
  };

  [[nodiscard]] bool starts_with_rig() const {
    return uses_imu_ && config_.calibration_agreement_probability > 0.0;
  }
  [[nodiscard]] bool compares_lens() const { return starts_with_rig() && config_.estimate_lens; }
  [[nodiscard]] bool compares_depth_scale() const {
    return starts_with_rig() && config_.depth.estimate_scale;
  }
  void compare_extrinsics(const Vector6& step, const Matrix6& covariance, Window& window);
  void compare_depth_scale(double step, double variance, Window& window);
  void compare_lens(const Eigen::Vector4d& step, const Eigen::Matrix4d& covariance, Window& window);
  [[nodiscard]] bool agrees_with_rig(double contradiction, int degrees_of_freedom) const;
  /// Whether there is an alignment that contradicts the rig.
  [[nodiscard]] bool is_aligned_otherwise() const;

  BackendConfig config_;
  bool uses_imu_;
  Rig rig_;
  std::optional<RotationAlignment> rotation_alignment_;  ///< found at the start
  std::optional<double> time_offset_found_s_;            ///< before the rotation, and contradicts the rig
  std::optional<Timestamp> compared_since_;              ///< depth scales
  std::optional<Pose> extrinsics_found_;                 ///< contradict the rig
  std::optional<DepthScaleEstimate> depth_scale_found_;  ///< same
  std::optional<LensEstimate> lens_found_;               ///< same
  double depth_scale_prior_;                             ///< standard deviation in the prior of the window
  double depth_scale_confirmed_;  ///< smallest one with which the depth scale of the rig was confirmed
};

/// Whether no step of depth scale and lens exceeds a quarter of its standard deviation.
/// @param constant calibration that does not have to converge
/// @param covariance of the state of the last solve, as `step`
[[nodiscard]] bool has_converged(const AgreesWithRig& constant, const RigStep& step,
                                 const StateCovariance& covariance);

/// Sets what the IMU measures at the exposure of a frame to means over up to 40 ms around it, if there are
/// samples on both sides. Image velocities and the inertial residual's derivative by the time offset are
/// computed from them: the noise of a single sample would count as information about the time offset, and
/// bias it towards its current value.
void average_imu_at_exposure(const ImuBuffer& imu, WindowFrame& frame);

/// Whether that is done: the calibration is observed by inertial data at the exposures.
[[nodiscard]] inline bool averages_imu(const BackendConfig& config) {
  return config.time_offset_model == TimeOffsetModel::kInertial || config.prior == PriorModel::kConsistent;
}

/// Adds the configured random walks of time offset and extrinsics to a prior.
/// @param agrees extrinsics that agree with the rig do not walk
/// @param seconds by which the prior advances: from the oldest frame to the next one
void add_calibration_walk(const BackendConfig& config, const AgreesWithRig& agrees, double seconds,
                          LinearPrior& prior);

}  // namespace stillpoint
