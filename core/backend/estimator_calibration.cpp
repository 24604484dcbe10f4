// SPDX-License-Identifier: BSD-3-Clause
// The calibration that a window of the estimator starts with.
#include <algorithm>
#include <cmath>

#include "core/backend/estimator.h"
#include "core/backend/start/initial_prior.h"
#include "core/geometry/covariance.h"

namespace stillpoint {
namespace {

constexpr int kAlignedDegreesOfFreedom = 4;  // rotation and time offset

/// Variance of the direction of gravity that was estimated with a wrong calibration [rad^2].
constexpr double kUncertainGravity = 0.05 * 0.05;

/// The step is one of Gauss-Newton from the rig: its error of second order is about its square.
DepthScaleEstimate found_depth_scale(const RigContradiction& contradiction) {
  const double step = contradiction.depth_scale_step;
  return {.value = 1.0 + step, .sigma = std::hypot(contradiction.depth_scale_sigma, step * step)};
}

}  // namespace

/// The features need measured depth, by which the window can also start anew without an IMU.
bool Estimator::aligns_rotations() const {
  return backend_.initializer.align_rotations && uses_imu() && backend_.estimate_extrinsics &&
         backend_.depth.usage != DepthUsage::kOff && !rotation_alignment_;
}

/// Makes calibration that the data contradicts variable. With a wrong rotation or depth scale, the states of
/// the window are far from the true ones, and its prior is linearized at the wrong point: it starts anew, for
/// which vision is needed.
void Estimator::free_calibration() {
  if (monitor_.status() == OdometryStatus::kDeadReckoning) return;
  if (aligns_rotations()) {
    align_rotations();
  } else if (depth_scale_found_ && window_.agrees_with_rig.depth_scale) {
    restart_with_calibration(newest_.gyro_bias);
  }
}

void Estimator::align_rotations() {
  if (!window_.frames.empty()) {
    if (const std::optional<CameraRotation> rotation = camera_rotations_.add(window_))
      rotation_aligner_.add(*rotation);
  }
  rotation_alignment_ = rotation_aligner_.align(evidence_.t, imu_);
  if (!rotation_alignment_ || agrees_with_rig(*rotation_alignment_)) return;
  restart_with_calibration(rotation_alignment_->gyro_bias);
}

/// With the newest frame, at the same pose of its camera. Gravity and biases were estimated with the
/// calibration of the rig: gravity is uncertain, and the bias of the accelerometer is forgotten.
/// @param gyro_bias known without that calibration, or hardly affected by it
void Estimator::restart_with_calibration(const Eigen::Vector3d& gyro_bias) {
  const Pose T_before_after = window_.T_b_c * calibrated_window().T_b_c.inverse();
  NavState previous = previous_;
  previous.T_w_b = previous.T_w_b * T_before_after;
  const std::optional<std::int64_t> id =
      window_.frames.empty() ? std::nullopt : std::optional(window_.frames.back().id);
  std::vector<Landmark> landmarks = landmarks_of_newest(window_);
  window_.inertial = false;
  if (window_.gravity_covariance)
    *window_.gravity_covariance = kUncertainGravity * Eigen::Matrix2d::Identity();
  restart(window_.gravity_w);
  depth_rejected_since_.reset();
  newest_.T_w_b = newest_.T_w_b * T_before_after;
  newest_.gyro_bias = gyro_bias;
  newest_.accel_bias.setZero();
  previous_ = previous;
  if (!id) return;
  begin_window({.id = *id, .state = newest_, .time_offset_s = window_.time_offset_s});
  window_.landmarks = std::move(landmarks);
}

/// @param first with its state
void Estimator::begin_window(WindowFrame first) {
  if (averages_imu()) average_imu_at_exposure(imu_, first);
  window_.frames.push_back(std::move(first));
  window_.prior = initial_prior(window_, backend_);
  window_.calibration = prior_of_calibration();
}

/// Without frames, with the calibration that its prior is about.
Window Estimator::calibrated_window() const {
  Window window;
  window.T_b_c = rig_.T_b_c;
  window.time_offset_s = rig_.time_offset_s;
  window.time_offset_model = backend_.time_offset_model;
  const bool starts_with_rig = uses_imu() && backend_.calibration_agreement_probability > 0.0;
  window.agrees_with_rig = {
      .extrinsics = starts_with_rig && backend_.estimate_extrinsics,
      .depth_scale = starts_with_rig && backend_.depth.estimate_scale && !depth_scale_found_};
  if (depth_scale_found_) window.depth_scale = depth_scale_found_->value;
  if (!rotation_alignment_ || agrees_with_rig(*rotation_alignment_)) return window;
  window.T_b_c.q = rotation_alignment_->q_b_c;
  window.time_offset_s = rotation_alignment_->time_offset_s;
  window.agrees_with_rig.extrinsics = false;
  return window;
}

bool Estimator::agrees_with_rig(double contradiction, int degrees_of_freedom) const {
  return chi_square_tail(contradiction, degrees_of_freedom) >=
         1.0 - backend_.calibration_agreement_probability;
}

bool Estimator::agrees_with_rig(const RotationAlignment& alignment) const {
  return agrees_with_rig(alignment.rig_contradiction, kAlignedDegreesOfFreedom);
}

/// By the residuals of the last solve. Until rotations are aligned, it is not known which value is wrong.
void Estimator::compare_with_rig(const RigContradiction& contradiction) {
  AgreesWithRig& agrees = window_.agrees_with_rig;
  if (agrees.depth_scale) {
    depth_scale_found_.reset();
    if (!agrees_with_rig(contradiction.depth_scale, local_size(BlockKind::kDepthScale)))
      depth_scale_found_ = found_depth_scale(contradiction);
  }
  if (!aligns_rotations())
    agrees.extrinsics &= agrees_with_rig(contradiction.extrinsics, local_size(BlockKind::kExtrinsics));
}

/// About the rig. A depth scale that was found is known by the residuals of windows that are given up, and
/// rotation and time offset, if they contradict the rig, by the rotations that they were aligned with.
LinearPrior Estimator::prior_of_calibration() const {
  const Window window = calibrated_window();
  BackendConfig config = backend_;
  if (depth_scale_found_)
    config.depth.scale_sigma = std::min(config.depth.scale_sigma, depth_scale_found_->sigma);
  if (!rotation_alignment_ || agrees_with_rig(*rotation_alignment_)) return calibration_prior(window, config);
  return aligned_calibration_prior(window, config, rotation_alignment_->covariance);
}

}  // namespace stillpoint
