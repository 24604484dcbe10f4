// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/estimator.h"

#include <utility>

#include "core/backend/factors/gravity_direction.h"
#include "core/backend/online_calibration.h"
#include "core/backend/solvers/window_problem.h"
#include "core/backend/standstill.h"
#include "core/backend/start/config_check.h"
#include "core/backend/start/depth_initialization.h"
#include "core/backend/start/frozen_world.h"
#include "core/backend/start/initial_prior.h"
#include "core/backend/start/initializer.h"
#include "core/backend/start/monocular_structure.h"
#include "core/backend/window/landmark_tracks.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

/// Largest bias change from the linearization point for which the first-order correction is used.
constexpr double kRepropagateGyro = 0.01;  // [rad/s]
constexpr double kRepropagateAccel = 0.1;  // [m/s^2]

ImuNoise configured_noise(const ImuNoise& stated, const ImuConfig& config) {
  const auto density = [&](double configured, double of_sequence) {
    return config.noise_scale * (configured > 0.0 ? configured : of_sequence);
  };
  return {density(config.gyro_noise, stated.gyro_noise), density(config.accel_noise, stated.accel_noise),
          density(config.gyro_walk, stated.gyro_walk), density(config.accel_walk, stated.accel_walk)};
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

Estimator::Estimator(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed)
    : backend_(backend),
      imu_config_(imu),
      rig_(rig),
      seed_(static_cast<std::uint32_t>(seed)),
      imu_(imu.max_gap_s),
      solver_(make_window_solver(backend.solver)),
      camera_rotations_(rig.camera.focal_px()),
      rotation_aligner_(backend, rig),
      monitor_(monitor_options(backend, imu, rig, seed)),
      step_check_(rig.camera.focal_px()),
      bias_check_(rig.camera.focal_px()) {
  if (imu.enabled && !rig.has_imu) {
    throw InputError("imu.enabled", "the sequence has no inertial data; run with --variant vo");
  }
  check_config(backend, imu);
  rig_.imu_noise = configured_noise(rig.imu_noise, imu);
  window_ = calibrated_window();
}

MotionState Estimator::motion_state() const {
  return {.newest = newest_,
          .previous = previous_,
          .T_b_c = window_.T_b_c,
          .gravity_w = window_.gravity_w,
          .time_offset_s = window_.time_offset_s,
          .initialized = !window_.frames.empty(),
          .uses_imu = uses_imu(),
          .inertial = window_.inertial && inertial_check_.is_consistent()};
}

void Estimator::push_frame(const TrackedFrame& frame) {
  WindowFrame next;
  next.id = frame.id;
  next.time_offset_s = window_.time_offset_s;
  if (window_.frames.empty()) {
    next.state = newest_;
    next.state.t = frame.t;
    return begin_window(std::move(next));
  }
  next.state = extrapolate(motion_state(), imu_, frame.t);
  if (uses_imu()) integrate_samples(window_.frames.back(), next);
  window_.frames.push_back(std::move(next));
}

/// Missing samples of an inertial window are replaced by those of a constant velocity; wrong and missing ones
/// get a large noise, so that vision determines the motion.
void Estimator::integrate_samples(const WindowFrame& last, WindowFrame& next) {
  const Timestamp begin = after(last.state.t, last.time_offset_s);
  const Timestamp end = after(next.state.t, next.time_offset_s);
  const std::vector<ImuSample>& samples = imu_.samples_up_to(begin, end);
  evidence_.imu_defect = inspector_.inspect(samples, imu_config_.max_gap_s);
  if (evidence_.imu_defect == StatusReason::kImuGap) inertial_check_.missing(end);
  if (evidence_.imu_defect == StatusReason::kNone && !inertial_check_.is_consistent()) {
    evidence_.imu_defect = StatusReason::kImuInconsistent;
  }
  const bool missing = samples.size() < 2;
  if (missing && (!window_.inertial || begin >= end)) return;
  next.imu_is_reliable = evidence_.imu_defect == StatusReason::kNone;
  const ImuNoise noise = next.imu_is_reliable ? rig_.imu_noise : unreliable_noise(rig_.imu_noise);
  next.from_previous.emplace(noise, last.state.gyro_bias, last.state.accel_bias,
                             window_.sample_pool.acquire());
  if (missing) {
    next.from_previous->integrate(constant_velocity_samples(last.state, window_.gravity_w, begin, end));
  } else {
    next.from_previous->integrate(samples);
  }
  next.gyro_b = next.from_previous->samples().back().gyro_b;
  next.accel_b = next.from_previous->samples().back().accel_b;
  if (next.imu_is_reliable && averages_imu()) average_imu_at_exposure(imu_, next);
}

void Estimator::repropagate_preintegrations() {
  for (std::size_t i = 1; i < window_.frames.size(); ++i) {
    std::optional<Preintegration>& imu = window_.frames[i].from_previous;
    const NavState& state = window_.frames[i - 1].state;
    if (!imu) continue;
    const bool far = (state.gyro_bias - imu->gyro_bias()).norm() > kRepropagateGyro ||
                     (state.accel_bias - imu->accel_bias()).norm() > kRepropagateAccel;
    if (far) imu->repropagate(state.gyro_bias, state.accel_bias);
  }
}

void Estimator::try_initialize_imu() {
  if (!uses_imu() || window_.inertial) return;
  const double span = seconds_between(window_.frames.front().state.t, window_.frames.back().state.t);
  const bool instant = backend_.initializer.kind == InitializerKind::kInstant && window_.newest() >= 4;
  if (!is_full() && !(instant && span >= backend_.initializer.min_span_s)) return;
  std::optional<Window> visual =
      has_metric_scale() ? window_ : reconstruct_window(window_, backend_, rig_.camera.focal_px(), *solver_);
  if (!visual) return;
  const std::optional<InertialAlignment> alignment =
      align_with_imu(*visual, imu_config_.gravity, backend_.initializer);
  if (!alignment) return;
  const Pose anchor = window_.frames.front().state.T_w_b;
  if (backend_.gravity == GravityModel::kEstimated) {
    apply_alignment_to_frozen_world(*alignment, anchor, *visual);
  } else {
    apply_alignment(*alignment, anchor, *visual);
  }
  window_ = std::move(*visual);
  window_.prior = initial_prior(window_, backend_);
  inertial_check_.reset();
}

void Estimator::slide(bool keyframe) {
  if (!is_full()) return;
  if (!has_metric_scale()) {
    keyframe ? remove_oldest_frame(window_) : remove_second_newest_frame(window_);
    window_.prior = initial_prior(window_, backend_);
  } else if (keyframe) {
    LinearPrior prior = solver_->marginalize_oldest(window_, pixel_noise_.applied_to(backend_),
                                                    rig_.camera.focal_px(), std::move(discarded_prior_));
    add_calibration_walk(backend_, window_.agrees_with_rig,
                         seconds_between(window_.frames[0].state.t, window_.frames[1].state.t), prior);
    remove_marginalized_information(backend_, window_);
    remove_oldest_frame(window_);
    discarded_prior_ = std::exchange(window_.prior, std::move(prior));
  } else {
    window_.prior = marginalizer_.remove(window_.newest() - 1, std::move(window_.prior));
    remove_second_newest_frame(window_);
  }
  // Nothing connected the removed frame to the others: fix the gauge at the new oldest frame.
  if (window_.prior.empty()) window_.prior = initial_prior(window_, backend_);
}

void Estimator::begin_update(std::int64_t frame_id) {
  ModuleTimings timings = std::move(update_.timings);
  timings.clear();
  update_ = {.frame_id = frame_id, .timings = std::move(timings)};
  oldest_motion_.reset();
}

void Estimator::add(const TrackedFrame& frame) {
  begin_update(frame.id);
  update_.counters.tracked_features = static_cast<int>(frame.features.size());
  evidence_ = {.t = frame.t,
               .features = static_cast<int>(frame.features.size()),
               .bridged = frame.repeated && newest_covariance_ && previous_.t < newest_.t};
  relocalize(frame);
  push_frame(frame);
  const ScopedTimer timer(update_.timings, Module::kStateOptimization, ScopedTimer::Kind::kPart);
  add_observations(frame, rig_, backend_.depth, window_);
  reject_depth_of_another_scale();
}

void Estimator::mark_dynamic(std::span<const DynamicLabel> labels) {
  auto landmark = window_.landmarks.begin();
  for (const DynamicLabel& label : labels) {
    while (landmark != window_.landmarks.end() && landmark->id < label.id) ++landmark;
    if (landmark == window_.landmarks.end()) return;
    if (landmark->id != label.id) continue;
    if (label.reason == LabelReason::kStatic) restart_track(*landmark);
    const bool cleared = landmark->dynamic && label.label == LabelClass::kStable;
    landmark->dynamic = label.label != LabelClass::kStable;
    if (!cleared) continue;
    landmark->inverse_depth = 0.0;  // it was estimated before the point moved
    landmark->source = DepthSource::kNone;
  }
}

void Estimator::solve() {
  initialize_depths(backend_, rig_.camera.focal_px(), window_);
  const ScopedTimer solve_timer(update_.timings, Module::kWindowSolve);
  const Pose oldest = window_.frames.front().state.T_w_b;
  const SolveReport report =
      solver_->solve(window_, pixel_noise_.applied_to(backend_), rig_.camera.focal_px());
  unusable_solves_ = report.usable ? 0 : unusable_solves_ + 1;
  update_.at_bound = limit_calibration(rig_, backend_, window_);
  if (!window_.inertial) restore_gauge(oldest, backend_, window_);
  if (backend_.covariance && report.usable) compute_covariance();
  if (backend_.reprojection_error_px > 0.0) {
    pixel_noise_.observe(error_monitor_.median_px(window_, rig_.camera.focal_px()), backend_);
  }
  update_.counters.window_landmarks = report.landmarks;
  update_.counters.depth_landmarks = report.depth_landmarks;
  update_.counters.solver_iterations = report.iterations;
}

void Estimator::compute_covariance() {
  const bool oldest_leaves = keyframe_ && is_full();
  const std::optional<WindowCovariance> covariance =
      solver_->covariance(window_, pixel_noise_.applied_to(backend_), rig_.camera.focal_px(), oldest_leaves);
  if (!covariance) return;
  update_.covariance = covariance->newest;
  contradiction_.add_to(*update_.covariance, window_.frames.back().state.t);
  oldest_motion_ = covariance->oldest_motion;
  compare_with_rig(covariance->rig);
}

bool Estimator::refine() {
  const ScopedTimer timer(update_.timings, Module::kStateOptimization);
  keyframe_ = is_second_newest_keyframe(window_, backend_, rig_.camera.focal_px());
  record_reprojection_nis();
  check_inertial_data();
  check_biases();
  localized_ = localize_newest();
  update_.counters.keyframe = keyframe_;
  if (!localized_) {
    discard_newest();
    return true;
  }
  try_initialize_imu();
  repropagate_preintegrations();
  if (backend_.zero_velocity.enabled) {
    window_.frames.back().at_rest = is_at_rest(window_, imu_, backend_.zero_velocity,
                                               {rig_.imu_noise, imu_config_.gravity, rig_.camera.focal_px()});
    update_.counters.at_rest = window_.frames.back().at_rest;
  }
  const Eigen::Vector3d gravity_before = window_.gravity_w;
  if (has_metric_scale()) solve();
  evidence_.failure = failure();
  if (evidence_.failure != StatusReason::kNone) {
    update_.counters.reset = true;
    restart(gravity_before);
    forget_biases();
  } else {
    previous_ = newest_;
    newest_ = window_.frames.back().state;
    newest_covariance_ = update_.covariance;
  }
  return update_status();
}

void Estimator::finish() {
  if (!window_.frames.empty()) {
    const ScopedTimer timer(update_.timings, Module::kStateOptimization, ScopedTimer::Kind::kPart);
    const ScopedTimer slide_timer(update_.timings, Module::kMarginalization);
    slide(keyframe_);
  }
  report(monitor_.reason() == StatusReason::kRepeatedImage ? bridged_ : newest_);
  free_calibration();
  if (!aligns_rotations()) drop_old_samples(motion_state(), imu_);
}

void Estimator::predict(std::int64_t frame_id, Timestamp t) {
  begin_update(frame_id);
  report(extrapolate(motion_state(), imu_, t));
}

void Estimator::report(const NavState& state) {
  update_.state = state;
  update_.T_w_c = state.T_w_b * window_.T_b_c;
  update_.status = monitor_.status();
  update_.reason = monitor_.reason();
  update_.segment = monitor_.segment();
  update_.inertial = motion_state().inertial;
  update_.time_offset_s = window_.time_offset_s;
  update_.depth_scale = window_.depth_scale;
  update_.agrees_with_rig = window_.agrees_with_rig;
  if (window_.gravity_covariance) update_.q_level_w = level_rotation(window_.gravity_w);
}

}  // namespace stillpoint
