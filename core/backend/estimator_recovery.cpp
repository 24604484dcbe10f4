// SPDX-License-Identifier: BSD-3-Clause
// The estimator's reaction to failures: unreliable inertial data, loss of vision, restart.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/backend/estimator.h"
#include "core/backend/failure_detection.h"
#include "core/backend/window/landmark_tracks.h"
#include "core/geometry/covariance.h"
#include "core/geometry/so3.h"
#include "core/imu/zero_velocity.h"

namespace stillpoint {
namespace {

/// Inlier threshold of the visual poses that inertial data is compared with.
constexpr double kVisualPoseInlier_px = 3.0;

/// Inertial data that contradicts vision was wrong before it was recognized.
constexpr double kRecognitionDelay_s = 0.15;

/// Age of a step of the biases when it is recognized, at most.
constexpr double kBiasStepDelay_s = 0.6;

/// Duration of errors that are not those of a bias, and of agreement after which the data is used again.
constexpr double kMaxDifference_s = 1.0;
constexpr double kMinAgreement_s = 0.7;

/// Solver failures in succession after which the window is given up.
constexpr int kMaxUnusableSolves = 3;

constexpr double kMaxDepthRejection_s = 10.0;

/// Part of the limit below which a rejected scale agrees again: near the limit it would be accepted in single
/// frames, which pull the landmarks to it.
constexpr double kAgreeingScale = 0.5;

/// Standard deviations of an estimated depth scale within the largest accepted error.
constexpr double kKnownScaleSigmas = 3.0;

/// Features with a measured depth from which a window can start.
constexpr int kMinFirstFeatures = 8;

bool has_depth(const Landmark& landmark) {
  return !landmark.dynamic && !landmark.observations.empty() && landmark.observations.back().depth > 0.0;
}

/// Acceleration of a camera in the hand.
constexpr double kAcceleration = 2.0;         // [m/s^2]
constexpr double kAngularAcceleration = 5.0;  // [rad/s^2]

/// Covariance of (dp, dtheta) that constant velocity adds to the pose of `newest`, see StateCovariance. With
/// the predicted motion d = (p_k - p_n, Log(q_n^-1 q_k)) during t, and the accelerations a,
///
///   Q = d d^T + diag((a t^2)^2).
///
/// The first term covers a camera that stopped: when it repeats an image, its time stamps are doubtful, too.
Matrix6 prediction_covariance(const NavState& newest, const NavState& predicted) {
  Eigen::Matrix<double, 6, 1> motion;
  motion << predicted.T_w_b.p - newest.T_w_b.p, log_so3(newest.T_w_b.q.conjugate() * predicted.T_w_b.q);
  const double t = seconds_between(newest.t, predicted.t);
  Matrix6 covariance = motion * motion.transpose();
  covariance.diagonal().head<3>().array() += std::pow(kAcceleration * t * t, 2);
  covariance.diagonal().tail<3>().array() += std::pow(kAngularAcceleration * t * t, 2);
  return covariance;
}

bool is_finite(const LinearPrior& prior) { return prior.jacobian.allFinite() && prior.residual.allFinite(); }

}  // namespace

/// While the scale of the rig is compared with the data, the comparison needs the depth until it is certain.
bool Estimator::knows_depth_scale() const {
  return !window_.agrees_with_rig.depth_scale ||
         (newest_covariance_ &&
          kKnownScaleSigmas * std::sqrt(newest_covariance_->depth_scale) < backend_.depth.max_scale_error);
}

/// For a limited time: if the contradiction persists, the landmarks are wrong.
void Estimator::reject_depth_of_another_scale() {
  if (backend_.depth.max_scale_error <= 0.0 || !knows_depth_scale()) return;
  const std::optional<double> scale = depth_scale_.of_newest(window_);
  const Timestamp t = window_.frames.back().state.t;
  if (scale && std::abs(*scale - 1.0) <= kAgreeingScale * backend_.depth.max_scale_error)
    depth_rejected_since_.reset();
  if (scale && std::abs(*scale - 1.0) > backend_.depth.max_scale_error && !depth_rejected_since_)
    depth_rejected_since_ = t;
  if (!depth_rejected_since_ || seconds_between(*depth_rejected_since_, t) > kMaxDepthRejection_s) return;
  for (Landmark& landmark : window_.landmarks) {
    if (landmark.last() == window_.newest()) landmark.observations.back().depth = 0.0;
  }
}

/// Compares inertial data with the pose by vision alone. Wrong data of the last frames is replaced. Inertial
/// data of a body at rest is not compared: disturbances do not look like rest, but a person who covers most
/// of the image looks like a motion of the camera.
void Estimator::check_inertial_data() {
  if (!window_.inertial || !window_.frames.back().from_previous) return;
  WindowFrame& newest = window_.frames.back();
  if (zero_velocity_statistic(newest.from_previous->samples(), newest.state, rig_.imu_noise,
                              imu_config_.gravity) <= backend_.zero_velocity.statistic) {
    return;
  }
  known_points_ = known_points(window_, backend_.depth, std::move(known_points_));
  const double focal_px = rig_.camera.focal_px();
  const Pose T_w_c =
      refine_camera_pose(known_points_, newest.state.T_w_b * window_.T_b_c, kVisualPoseInlier_px / focal_px);
  const VisionAssessment vision = assess_vision(known_points_, T_w_c, kVisualPoseInlier_px / 5.0 / focal_px);
  if (!vision.may_contradict_imu(evidence_.features)) {
    if (!vision.is_located(false)) inertial_check_.interrupt(newest.state.t);
    return;
  }
  record_inertial_nis(T_w_c, kVisualPoseInlier_px / focal_px);
  const bool was_consistent = inertial_check_.is_consistent();
  const VisualPose pose{.t = after(newest.state.t, newest.time_offset_s),
                        .T_w_b = T_w_c * window_.T_b_c.inverse(),
                        .sigma_m = vision.sigma_m,
                        .sigma_rad = vision.sigma_rad};
  if (inertial_check_.update(pose, newest_, window_.gravity_w, imu_) || !was_consistent) return;
  evidence_.imu_defect = StatusReason::kImuInconsistent;
  distrust_recent_samples();
}

/// A step of the biases: their random walk in the samples that it was recognized by is enlarged, so that the
/// solver follows it. Errors that persist are not those of a bias: the data is not used until they end. While
/// the time offset converges, errors are its own: the solver needs the data, and only the uncertainty grows.
void Estimator::check_biases() {
  const WindowFrame& newest = window_.frames.back();
  if (!backend_.bias_steps || !window_.inertial || !newest.from_previous) return;
  const Timestamp t = newest.state.t;
  const bool settled = offset_settling_.update(t, window_.time_offset_s);
  const BiasCheck::Result result = bias_check_.update(window_, imu_);
  if (result == BiasCheck::Result::kUnknown) return;
  if (result == BiasCheck::Result::kDiffers || result == BiasCheck::Result::kDoubtful ||
      (result == BiasCheck::Result::kStep && !settled)) {
    contradiction_.begin_or_continue(bias_check_.measured(), newest.state);
  } else {
    contradiction_.end();
  }
  if (result == BiasCheck::Result::kDoubtful || !settled) return;
  std::optional<Timestamp>& since =
      result == BiasCheck::Result::kAgrees ? biases_agree_since_ : biases_differ_since_;
  if (!since) since = t;
  (result == BiasCheck::Result::kAgrees ? biases_differ_since_ : biases_agree_since_).reset();
  if (biases_differ_since_ && seconds_between(*biases_differ_since_, t) > kMaxDifference_s) {
    inertial_check_.contradict();
    inertial_check_.hold(true);
    evidence_.imu_defect = StatusReason::kImuInconsistent;
    distrust_recent_samples();
  } else if (biases_agree_since_ && seconds_between(*biases_agree_since_, t) > kMinAgreement_s) {
    inertial_check_.hold(false);
  }
  if (result == BiasCheck::Result::kStep && has_inertial_prediction())
    enlarge_bias_walk(bias_check_.measured());
}

void Estimator::enlarge_bias_walk(const MeasuredBiases& measured) {
  const NavState& newest = window_.frames.back().state;
  for (WindowFrame& frame : window_.frames) {
    if (!frame.from_previous || !frame.imu_is_reliable ||
        seconds_between(frame.state.t, newest.t) > kBiasStepDelay_s) {
      continue;
    }
    const double root_s = std::sqrt(frame.from_previous->duration_s());
    ImuNoise noise = rig_.imu_noise;
    noise.gyro_walk = std::max(noise.gyro_walk, (measured.gyro - newest.gyro_bias).norm() / root_s);
    noise.accel_walk = std::max(noise.accel_walk, (measured.accel - newest.accel_bias).norm() / root_s);
    frame.from_previous->set_noise(noise);
  }
}

void Estimator::distrust_recent_samples() {
  const Timestamp newest = window_.frames.back().state.t;
  for (WindowFrame& frame : window_.frames) {
    if (!frame.from_previous || seconds_between(frame.state.t, newest) > kRecognitionDelay_s) continue;
    frame.imu_is_reliable = false;
    frame.from_previous->set_noise(unreliable_noise(rig_.imu_noise));
  }
}

/// Without inertial prediction: estimates the newest camera pose from known points (PnP).
/// @return whether inertial data or vision located the newest frame
bool Estimator::localize_newest() {
  WindowFrame& newest = window_.frames.back();
  if (has_inertial_prediction()) return newest.from_previous.has_value();
  if (window_.newest() == 0 || !has_metric_scale()) return true;
  Pose prediction = newest.state.T_w_b;
  if (newest.from_previous && newest.imu_is_reliable) {
    const NavState& before = window_.frames[window_.frames.size() - 2].state;
    prediction.q = before.T_w_b.q * newest.from_previous->delta_q(before.gyro_bias);
  }
  const CameraPoseOptions options{.inlier_threshold = kLocalizationInlier_px / rig_.camera.focal_px(),
                                  .seed = seed_ + static_cast<std::uint32_t>(newest.id)};
  known_points_ = known_points(window_, backend_.depth, std::move(known_points_));
  const std::optional<CameraPose> found =
      estimate_camera_pose(known_points_, prediction * window_.T_b_c, options);
  newest.state.T_w_b = found ? found->T_w_c * window_.T_b_c.inverse() : prediction;
  return found.has_value();
}

/// The newest frame was located by neither vision nor inertial data. A window that has not started begins
/// anew: its poses would depend on this one.
void Estimator::discard_newest() {
  const NavState predicted = window_.frames.back().state;
  if (monitor_.status() == OdometryStatus::kInitializing) {
    restart(window_.gravity_w);
  } else {
    remove_newest_frame(window_);
  }
  static_cast<void>(update_status());
  if (monitor_.reason() == StatusReason::kRepeatedImage) {
    bridged_ = predicted;
    update_.covariance = newest_covariance_;
    update_.covariance->state.topLeftCorner<6, 6>() += prediction_covariance(newest_, predicted);
    return;
  }
  previous_ = newest_;
  newest_.v_w.setZero();
}

/// Why the estimate must be given up, if so.
StatusReason Estimator::failure() const {
  if (has_failed(newest_, window_.frames.back().state) || !is_finite(window_.prior)) {
    return StatusReason::kDiverged;
  }
  return unusable_solves_ >= kMaxUnusableSolves ? StatusReason::kSolveFailed : StatusReason::kNone;
}

/// @return false if the window was cleared
bool Estimator::update_status() {
  evidence_.inertial = window_.inertial;
  evidence_.has_start = uses_imu() ? window_.inertial : has_metric_scale();
  evidence_.located = false;
  evidence_.contradiction = contradiction_.holds_at(evidence_.t);
  if (update_.covariance) evidence_.sigma_m = largest_sigma(update_.covariance->position());
  const bool alive = evidence_.failure == StatusReason::kNone;
  if (alive && localized_ && !window_.frames.empty()) assess_newest();
  const bool clear = monitor_.update(evidence_, window_);
  if (clear) restart(window_.gravity_w);
  return alive && !clear;
}

void Estimator::assess_newest() {
  if (window_.newest() == 0) {
    const auto measured = std::ranges::count_if(window_.landmarks, has_depth);
    evidence_.located = measured >= kMinFirstFeatures;
    return;
  }
  known_points_ = known_points(window_, backend_.depth, std::move(known_points_));
  evidence_.vision = assess_vision(known_points_, window_.T_w_c(window_.newest()),
                                   backend_.feature_sigma_px / rig_.camera.focal_px());
  evidence_.located =
      evidence_.vision.is_located(window_.inertial && evidence_.imu_defect == StatusReason::kNone);
}

/// Clears the window; the next frame starts at the last valid pose, so the world frame is preserved.
/// @param gravity_w before the solve that failed; an estimated one is kept with its covariance
void Estimator::restart(const Eigen::Vector3d& gravity_w) {
  Window fresh = calibrated_window();
  fresh.gravity_w = gravity_w;
  fresh.gravity_covariance =
      window_.estimates_gravity() ? gravity_covariance(window_.prior) : window_.gravity_covariance;
  if (fresh.gravity_covariance && !fresh.gravity_covariance->allFinite()) fresh.gravity_covariance.reset();
  window_ = std::move(fresh);
  newest_.v_w.setZero();
  previous_ = newest_;
  newest_covariance_.reset();
  unusable_solves_ = 0;
  inertial_check_.reset();
  step_check_.reset();
  bias_check_.reset();
  offset_settling_.reset();
  contradiction_.end();
  biases_differ_since_.reset();
  biases_agree_since_.reset();
}

/// After a divergence, which the biases were part of.
void Estimator::forget_biases() {
  newest_.gyro_bias.setZero();
  newest_.accel_bias.setZero();
  previous_ = newest_;
}

}  // namespace stillpoint
