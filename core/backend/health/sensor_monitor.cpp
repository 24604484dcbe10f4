// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/health/sensor_monitor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/backend/vision/vision_assessment.h"
#include "core/config/monitor_config.h"
#include "core/geometry/covariance.h"
#include "core/imu/zero_velocity.h"

namespace stillpoint {
namespace {

/// Whether an optimized state is not finite, has an implausible bias, or moved too far in one frame.
bool has_failed(const NavState& before, const NavState& now) {
  const bool finite = now.T_w_b.p.allFinite() && now.T_w_b.q.coeffs().allFinite() && now.v_w.allFinite() &&
                      now.gyro_bias.allFinite() && now.accel_bias.allFinite();
  return !finite || now.accel_bias.norm() > kMonitor.failure.max_accel_bias ||
         now.gyro_bias.norm() > kMonitor.failure.max_gyro_bias ||
         (now.T_w_b.p - before.T_w_b.p).norm() > kMonitor.failure.max_jump_m;
}

bool is_finite(const LinearPrior& prior) { return prior.jacobian.allFinite() && prior.residual.allFinite(); }

/// Whether there is a measured depth in the newest frame.
bool has_depth(const Landmark& landmark, const Window& window) {
  return !landmark.dynamic && !landmark.observations.empty() && landmark.last() == window.newest() &&
         landmark.observations.back().depth > 0.0;
}

bool has_first_features(const Window& window) {
  const auto measured = [&](const Landmark& landmark) { return has_depth(landmark, window); };
  return std::ranges::count_if(window.landmarks, measured) >= kMonitor.tracking.min_first_features;
}

MonitorOptions monitor_options(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed) {
  return {.uses_imu = imu.enabled,
          .inlier_threshold = kLocalizationInlier_px / rig.camera.focal_px(),
          .bearing_sigma = backend.feature_sigma_px / rig.camera.focal_px(),
          .max_dead_reckoning_s = backend.max_dead_reckoning_s,
          .max_relocalization_s = backend.max_relocalization_s,
          .seed = static_cast<std::uint32_t>(seed)};
}

}  // namespace

SensorMonitor::SensorMonitor(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed)
    : backend_(backend),
      imu_(imu),
      rig_(rig),
      tracking_(monitor_options(backend, imu, rig, seed)),
      noise_(rig.imu_noise),
      step_(rig.camera.focal_px()),
      biases_(rig.camera.focal_px()),
      depth_(backend.depth.max_scale_error, rig.camera.focal_px()),
      moving_world_(rig.camera.focal_px()) {}

void SensorMonitor::begin_frame(const TrackedFrame& frame, bool bridged) {
  evidence_ = {.t = frame.t, .features = static_cast<int>(frame.features.size()), .bridged = bridged};
  innovations_ = {};
}

bool SensorMonitor::inspect(const InspectedInterval& interval) {
  evidence_.imu_defect = inspector_.inspect(interval.samples, interval.gap.is_long);
  if (evidence_.imu_defect == StatusReason::kImuGap) inertial_.missing(interval.end);
  inertial_.end_old_doubt(interval.end);
  const bool continues = interval.samples.size() >= 2;  // else they have not arrived
  if (interval.gap.may_be_jump && continues && interval.inertial && is_located(status()))
    inertial_.doubt(interval.end);
  if (evidence_.imu_defect == StatusReason::kNone && !inertial_.is_consistent()) {
    evidence_.imu_defect = StatusReason::kImuInconsistent;
  }
  return evidence_.imu_defect == StatusReason::kNone;
}

void SensorMonitor::check_step(ImuBuffer& imu, Window& window) {
  if (!window.has_inertial_prediction() || !window.frames.back().from_previous) return;
  if (!step_.is_wrong(window, imu)) return;
  inertial_.contradict();
  evidence_.imu_defect = StatusReason::kImuInconsistent;
  distrust_recent_samples(window);
}

bool SensorMonitor::has_unexpected_features(const Expectation& expected, const Window& window) {
  if (!expected.camera) return false;
  innovations_.reprojection = reprojection_nis(window, *expected.camera, expected.residual_sigma, distances_);
  return innovations_.reprojection > kMonitor.innovation.unexpected;
}

void SensorMonitor::compare_with_prediction(const Expectation& expected, const UncertainPose& visual,
                                            Timestamp t) {
  if (!expected.camera) return;
  innovations_.inertial = inertial_nis(*expected.camera, visual);
  if (imu_.adapt_noise) noise_.observe(*expected.camera, visual, seconds_between(expected.before.t, t));
}

double SensorMonitor::added_support(const Window& window, const Pose& predicted, const Pose& T_w_c) {
  old_points_ = old_points(window, backend_.depth, std::move(old_points_));
  const double threshold = kMonitor.vision.witness_inlier_px / rig_.camera.focal_px();
  return support(old_points_, T_w_c, threshold) - support(old_points_, predicted, threshold);
}

void SensorMonitor::check_inertial_data(const Expectation& expected, ImuBuffer& imu, Window& window) {
  if (!window.inertial || !window.frames.back().from_previous) return;
  const WindowFrame& newest = window.frames.back();
  if (zero_velocity_statistic(newest.from_previous->samples(), newest.state, rig_.imu_noise, imu_.gravity) <=
      kMonitor.inertial.rest_statistic) {
    return;
  }
  known_points_ = known_points(window, backend_.depth, std::move(known_points_));
  const double focal_px = rig_.camera.focal_px();
  const Pose predicted = product(newest.state.T_w_b, window.T_b_c);
  const Pose T_w_c = refine_camera_pose(known_points_, predicted, kMonitor.vision.pose_inlier_px / focal_px);
  const double inlier_sigma = kMonitor.vision.pose_inlier_px / kMonitor.vision.inlier_sigmas / focal_px;
  const VisionAssessment vision = assess_vision(known_points_, T_w_c, inlier_sigma);
  if (!vision.may_contradict_imu(evidence_.features)) {
    if (!vision.is_located(false)) inertial_.interrupt(newest.state.t);
    return;
  }
  const double confirmation = added_support(window, predicted, T_w_c);
  if (confirmation < -kMonitor.vision.max_witness_loss) return;
  compare_with_prediction(expected,
                          {T_w_c, std::pow(expected.white_sigma / inlier_sigma, 2) * vision.covariance},
                          newest.state.t);
  const bool was_consistent = inertial_.is_consistent();
  const Pose T_c_b = window.T_b_c.inverse();
  const VisualPose pose{.t = after(newest.state.t, newest.time_offset_s),
                        .T_w_b = product(T_w_c, T_c_b),
                        .covariance = in_frame({T_w_c, vision.covariance}, T_c_b).covariance,
                        .is_confirmed = confirmation > kMonitor.vision.max_witness_loss};
  if (inertial_.update(pose, expected.before, window.gravity_w, imu) || !was_consistent) return;
  evidence_.imu_defect = StatusReason::kImuInconsistent;
  distrust_recent_samples(window);
}

void SensorMonitor::check_biases(ImuBuffer& imu, Window& window) {
  if (!backend_.bias_steps || !window.inertial || !window.frames.back().from_previous) return;
  const BiasFindings found = biases_.update(window, imu);
  if (found.is_wrong) {
    inertial_.contradict();
    inertial_.hold(true);
    evidence_.imu_defect = StatusReason::kImuInconsistent;
    distrust_recent_samples(window);
  } else if (found.agrees) {
    inertial_.hold(false);
  }
  if (found.has_step) bias_step_ = biases_.measured();
  if (!bias_step_ || !window.has_inertial_prediction()) return;
  enlarge_bias_walk(*bias_step_, window);
  bias_step_.reset();
}

void SensorMonitor::enlarge_bias_walk(const MeasuredBiases& measured, Window& window) const {
  const NavState& newest = window.frames.back().state;
  for (WindowFrame& frame : window.frames) {
    if (!frame.from_previous || !frame.imu_is_reliable ||
        seconds_between(frame.state.t, newest.t) > kMonitor.bias.step_delay_s) {
      continue;
    }
    const double root_s = std::sqrt(frame.from_previous->duration_s());
    ImuNoise noise = noise_.densities();
    noise.gyro_walk = std::max(noise.gyro_walk, (measured.gyro - newest.gyro_bias).norm() / root_s);
    noise.accel_walk = std::max(noise.accel_walk, (measured.accel - newest.accel_bias).norm() / root_s);
    frame.from_previous->set_noise(noise);
  }
}

void SensorMonitor::distrust_recent_samples(Window& window) {
  const Timestamp newest = window.frames.back().state.t;
  for (WindowFrame& frame : window.frames) {
    if (!frame.from_previous ||
        seconds_between(frame.state.t, newest) > kMonitor.inertial.recognition_delay_s)
      continue;
    frame.imu_is_reliable = false;
    frame.from_previous->set_noise(unreliable_noise(rig_.imu_noise));
  }
}

StatusReason SensorMonitor::failure_of(const Window& window, const NavState& before, int unusable_solves) {
  if (has_failed(before, window.frames.back().state) || !is_finite(window.prior) ||
      (window.inertial && moving_world_.update(window))) {
    return StatusReason::kDiverged;
  }
  return unusable_solves >= kMonitor.failure.max_unusable_solves ? StatusReason::kSolveFailed
                                                                 : StatusReason::kNone;
}

bool SensorMonitor::update_status(const Outcome& outcome, const Window& window) {
  evidence_.failure = outcome.failure;
  evidence_.inertial = window.inertial;
  evidence_.has_start = imu_.enabled ? window.inertial : outcome.has_metric_scale;
  evidence_.located = false;
  evidence_.contradiction = biases_.contradiction().holds_at(evidence_.t);
  if (outcome.covariance) evidence_.covariance = outcome.covariance->pose();
  const bool alive = evidence_.failure == StatusReason::kNone;
  if (alive && outcome.located && !window.frames.empty()) assess_newest(window);
  return tracking_.update(evidence_, window);
}

bool SensorMonitor::can_restart(const Window& window) const {
  return backend_.depth.usage != DepthUsage::kOff && !window.frames.empty() && has_first_features(window);
}

void SensorMonitor::assess_newest(const Window& window) {
  if (window.newest() == 0) {
    evidence_.located = has_first_features(window);
    return;
  }
  known_points_ = known_points(window, backend_.depth, std::move(known_points_));
  evidence_.vision = assess_vision(known_points_, window.T_w_c(window.newest()),
                                   backend_.feature_sigma_px / rig_.camera.focal_px());
  evidence_.located =
      evidence_.vision.is_located(window.inertial && evidence_.imu_defect == StatusReason::kNone);
}

void SensorMonitor::window_restarted() {
  inertial_.reset();
  step_.reset();
  biases_.reset();
  bias_step_.reset();
  moving_world_.reset();
}

}  // namespace stillpoint
