// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/estimator.h"

#include <cmath>
#include <utility>

#include "core/backend/factors/gravity_direction.h"
#include "core/backend/window/landmark_tracks.h"
#include "core/geometry/so3.h"

namespace stillpoint {
namespace {

/// 99 % quantile of the chi-square distribution with six degrees of freedom.
constexpr double kMaxPoseDistance = 16.81;

/// Most solves for the convergence of calibration that contradicts the rig.
constexpr int kCalibrationSolves = 15;

/// Acceleration of a camera in the hand.
constexpr double kAcceleration = 2.0;         // [m/s^2]
constexpr double kAngularAcceleration = 5.0;  // [rad/s^2]

/// The rig with the configured noise of the IMU.
Rig with_configured_noise(Rig rig, const ImuConfig& config) {
  const auto density = [&](double configured, double of_sequence) {
    return config.noise_scale * (configured > 0.0 ? configured : of_sequence);
  };
  const ImuNoise stated = rig.imu_noise;
  rig.imu_noise = {
      density(config.gyro_noise, stated.gyro_noise), density(config.accel_noise, stated.accel_noise),
      density(config.gyro_walk, stated.gyro_walk), density(config.accel_walk, stated.accel_walk)};
  return rig;
}

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

/// A pose found in the map, given the pose by dead reckoning: nothing if it contradicts the covariance that
/// dead reckoning claims, or if it differs by no more than its own error and so confirms dead reckoning;
/// else both are fused.
std::optional<UncertainPose> corrected_by_map(const UncertainPose& reckoned, const UncertainPose& found) {
  const Pose& T_w_b = reckoned.T_w_f;
  const bool confirmed = squared_distance(T_w_b, found.T_w_f, found.covariance) <= kMaxPoseDistance;
  const bool agrees =
      squared_distance(T_w_b, found.T_w_f, reckoned.covariance + found.covariance) <= kMaxPoseDistance;
  if (confirmed || !agrees) return std::nullopt;
  return fuse(reckoned, found);
}

}  // namespace

Estimator::Estimator(const BackendConfig& backend, const ImuConfig& imu, const Rig& rig, int seed)
    : uses_imu_(imu.enabled),
      imu_(imu.max_gap_s),
      calibration_(backend, imu.enabled, rig),
      start_(backend, imu, rig),
      window_(backend, rig, seed, calibration_.calibrated_window()),
      monitor_(backend, imu, with_configured_noise(rig, imu), seed) {}

OdometryUpdate& Estimator::process(const TrackedFrame& frame, DynamicLabeler* dynamic) {
  begin_update(frame.id);
  update_.counters.tracked_features = static_cast<int>(frame.features.size());
  monitor_.begin_frame(frame, frame.repeated && newest_covariance_ && previous_.t < newest_.t);
  relocalize(frame);
  append(frame);
  if (dynamic != nullptr) {
    label(dynamic->labels_by_detections(frame));
    if (dynamic->uses_prediction()) label_at_prediction(*dynamic);
  }
  const bool alive = refine();
  if (dynamic != nullptr) {
    label(dynamic->labels_after_refinement(
        {.window = window(), .failed = !alive, .oldest_motion = window_.oldest_motion()}));
  }
  slide();
  report(monitor_.reason() == StatusReason::kRepeatedImage ? bridged_ : newest_);
  free_calibration(frame.t);
  if (!calibration_.awaits_alignment()) drop_old_samples(motion_state(), imu_);
  return update_;
}

OdometryUpdate& Estimator::predict(std::int64_t frame_id, Timestamp t) {
  begin_update(frame_id);
  report(extrapolate(motion_state(), imu_, t));
  return update_;
}

MotionState Estimator::motion_state() const {
  const Window& window = window_.states();
  return {.newest = newest_,
          .previous = previous_,
          .T_b_c = window.T_b_c,
          .gravity_w = window.gravity_w,
          .time_offset_s = window.time_offset_s,
          .initialized = !window.frames.empty(),
          .uses_imu = uses_imu_,
          .inertial = window.inertial && monitor_.trusts_imu()};
}

void Estimator::begin_update(std::int64_t frame_id) {
  ModuleTimings timings = std::move(update_.timings);
  timings.clear();
  update_ = {.frame_id = frame_id, .timings = std::move(timings)};
}

/// While dead reckoning or lost: restarts the window at the pose found in the map of trusted landmarks.
void Estimator::relocalize(const TrackedFrame& frame) {
  const Pose& T_b_c = window().T_b_c;
  const Pose predicted = extrapolate(motion_state(), imu_, frame.t).T_w_b;
  const std::optional<UncertainPose> on_map = monitor_.relocalize(frame, product(predicted, T_b_c));
  if (!on_map) return;
  UncertainPose found = in_frame(*on_map, T_b_c.inverse());
  if (!monitor_.awaits_map()) {
    if (const std::optional<UncertainPose> reckoned = dead_reckoned_pose(frame.t)) {
      const std::optional<UncertainPose> corrected = corrected_by_map(*reckoned, found);
      if (!corrected) return;
      found = *corrected;
    }
  }
  restart(window().gravity_w);
  newest_.T_w_b = found.T_w_f;
  newest_.t = frame.t;
  previous_ = newest_;
  const UncertainPose& mapped = monitor_.map().T_w_b();
  origin_ = in_frame(mapped, mapped.T_w_f.inverse() * found.T_w_f);
  origin_.covariance += found.covariance;
  monitor_.relocated();
}

/// Pose at `t` by inertial data alone. The covariance of its position is relative to the trusted map, which
/// has the drift of before, too: while vision is lost that of the velocity, V, grows, so that T seconds after
/// the last update of the map it is at most T^2 V.
std::optional<UncertainPose> Estimator::dead_reckoned_pose(Timestamp t) {
  if (window_.empty() || !window().inertial) return std::nullopt;
  const std::optional<WindowCovariance> claim = window_.covariance(false);
  const double offset_s = window().time_offset_s;
  const std::vector<ImuSample>& samples = imu_.samples_up_to(after(newest_.t, offset_s), after(t, offset_s));
  if (!claim || samples.size() < 2) return std::nullopt;
  Preintegration motion(monitor_.imu_noise(true), newest_.gyro_bias, newest_.accel_bias);
  motion.integrate(samples);
  UncertainPose reckoned = predicted_pose(newest_, claim->newest, motion, window().gravity_w);
  reckoned.covariance.topRightCorner<3, 3>().setZero();
  reckoned.covariance.bottomLeftCorner<3, 3>().setZero();
  reckoned.covariance.topLeftCorner<3, 3>() =
      std::pow(seconds_between(monitor_.map().updated_at(), t), 2) * claim->newest.velocity();
  return reckoned;
}

/// Appends the frame at its predicted pose.
void Estimator::append(const TrackedFrame& frame) {
  WindowFrame next;
  next.id = frame.id;
  next.time_offset_s = window().time_offset_s;
  if (window_.empty()) {
    next.state = newest_;
    next.state.t = frame.t;
    start_.begin(std::move(next), calibration_, imu_, window_.states());
  } else {
    next.state = extrapolate(motion_state(), imu_, frame.t);
    if (uses_imu_) preintegrate(next);
    window_.append(std::move(next));
  }
  const ScopedTimer timer(update_.timings, Module::kStateOptimization, ScopedTimer::Kind::kPart);
  window_.add_features(frame);
  if (window().has_inertial_prediction()) monitor_.check_depth(newest_covariance_, window_.states());
}

void Estimator::preintegrate(WindowFrame& next) {
  const WindowFrame& last = window().frames.back();
  const Timestamp begin = after(last.state.t, last.time_offset_s);
  const Timestamp end = after(next.state.t, next.time_offset_s);
  const std::vector<ImuSample>& samples = imu_.samples_up_to(begin, end);
  const bool reliable = monitor_.inspect(
      {.samples = samples, .end = end, .gap = imu_.gap_in(begin, end), .inertial = window().inertial});
  window_.preintegrate({.samples = samples,
                        .begin = begin,
                        .end = end,
                        .noise = monitor_.imu_noise(reliable),
                        .is_reliable = reliable},
                       imu_, next);
}

/// Vision determines the pose if inertial data is wrong; no label follows from a prediction then.
void Estimator::label_at_prediction(DynamicLabeler& dynamic) {
  monitor_.check_step(imu_, window_.states());
  if (window().has_inertial_prediction()) label(dynamic.labels_at_prediction(window(), predicted_camera()));
}

/// Camera pose of the newest frame as predicted by inertial data, with its covariance relative to the frame
/// before, which the optimization claims; absent without reliable data, or if no covariance is known.
std::optional<UncertainPose> Estimator::predicted_camera() const {
  if (!window().has_inertial_prediction() || window().newest() < 1) return std::nullopt;
  const WindowFrame& newest = window().frames.back();
  const WindowFrame& before = window().frames[window().frames.size() - 2];
  if (!newest.from_previous || before.state.t != newest_.t) return std::nullopt;
  if (!newest_covariance_ || !newest_covariance_->inertial) return std::nullopt;
  const UncertainPose motion =
      predicted_motion(newest_, *newest_covariance_, *newest.from_previous, window().gravity_w);
  return in_frame(compose({.T_w_f = before.state.T_w_b}, motion), window().T_b_c);
}

/// Optimizes the window. @return false if the window was cleared
bool Estimator::refine() {
  const ScopedTimer timer(update_.timings, Module::kStateOptimization);
  window_.choose_keyframe();
  check_data();
  const bool located = window_.localize_newest();
  // A prediction by constant velocity is too inaccurate for the depths of landmarks in this frame.
  if (!window().has_inertial_prediction()) monitor_.check_depth(newest_covariance_, window_.states());
  update_.counters.keyframe = window_.keyframe();
  if (!located) {
    discard_newest();
    return true;
  }
  if (start_.initialize(window_.states(), window_.solver())) monitor_.world_changed();
  window_.prepare_solve();
  const Eigen::Vector3d gravity_before = window().gravity_w;
  if (window_.has_metric_scale()) solve();
  return accept_or_reset(gravity_before);
}

void Estimator::check_data() {
  const std::optional<UncertainPose> camera = predicted_camera();
  Expectation expected{.before = newest_,
                       .camera = camera,
                       .residual_sigma = window_.residual_sigma(),
                       .white_sigma = window_.white_sigma()};
  if (monitor_.has_unexpected_features(expected, window())) {
    window_.expect_errors();
    expected.residual_sigma = window_.residual_sigma();
  }
  monitor_.check_inertial_data(expected, imu_, window_.states());
  monitor_.check_biases(imu_, window_.states());
  update_.nis = monitor_.innovations();
}

void Estimator::solve() {
  const ScopedTimer timer(update_.timings, Module::kWindowSolve);
  const AgreesWithRig before = window().agrees_with_rig;
  optimize();
  converge_calibration(before);
}

/// A solve can move a depth scale or lens that was constant before by a part of its difference only. Without
/// convergence the window starts anew with what was reached.
void Estimator::converge_calibration(const AgreesWithRig& before) {
  const AgreesWithRig& now = window().agrees_with_rig;
  const auto is_found = [&] {
    return (before.depth_scale && !now.depth_scale) || (before.lens && !now.lens);
  };
  for (int i = 0; i < kCalibrationSolves && is_found() && window_.unusable_solves() == 0; ++i) {
    if (has_converged(now, update_.rig_step, *update_.covariance)) break;
    optimize();
  }
  if (is_found()) calibration_found_ = true;
}

void Estimator::optimize() {
  const SlidingWindow::Solution solution = window_.solve(calibration_);
  update_.at_bound = solution.at_bound;
  update_.counters.window_landmarks = solution.report.landmarks;
  update_.counters.depth_landmarks = solution.report.depth_landmarks;
  update_.counters.solver_iterations = solution.report.iterations;
  if (!solution.covariance) return;
  update_.covariance = solution.covariance->newest;
  add_origin(origin_, window().frames.back().state, window().gravity_w, *update_.covariance);
  monitor_.add_contradiction(window().frames.back().state.t, *update_.covariance);
  update_.rig_step = solution.covariance->rig_step;
  calibration_.compare_with_rig(update_.rig_step, *update_.covariance, window_.states());
}

/// The biases were part of a divergence, and are forgotten with it.
bool Estimator::accept_or_reset(const Eigen::Vector3d& gravity_before) {
  const StatusReason failure = monitor_.failure_of(window(), newest_, window_.unusable_solves());
  if (failure != StatusReason::kNone) {
    update_.counters.reset = true;
    restart(gravity_before);
    newest_.gyro_bias.setZero();
    newest_.accel_bias.setZero();
    previous_ = newest_;
  } else {
    previous_ = newest_;
    newest_ = window().frames.back().state;
    newest_covariance_ = update_.covariance;
  }
  return update_status(true, failure);
}

/// The newest frame was located by neither vision nor inertial data. A window that has not started begins
/// anew: its poses would depend on this one.
void Estimator::discard_newest() {
  const NavState predicted = window().frames.back().state;
  if (monitor_.status() == OdometryStatus::kInitializing) {
    restart(window().gravity_w);
  } else {
    window_.discard_newest();
  }
  static_cast<void>(update_status(false, StatusReason::kNone));
  if (monitor_.reason() == StatusReason::kRepeatedImage) {
    bridged_ = predicted;
    update_.covariance = newest_covariance_;
    update_.covariance->state.topLeftCorner<6, 6>() += prediction_covariance(newest_, predicted);
    return;
  }
  previous_ = newest_;
  newest_.v_w.setZero();
}

/// @return false if the window was cleared
bool Estimator::update_status(bool located, StatusReason failure) {
  const int segment = monitor_.segment();
  const bool clear = monitor_.update_status({.located = located,
                                             .has_metric_scale = window_.has_metric_scale(),
                                             .failure = failure,
                                             .covariance = update_.covariance},
                                            window());
  if (clear) restart(window().gravity_w);
  if (monitor_.segment() != segment) origin_.covariance.setZero();
  return failure == StatusReason::kNone && !clear;
}

void Estimator::slide() {
  if (window_.empty()) return;
  const ScopedTimer timer(update_.timings, Module::kStateOptimization, ScopedTimer::Kind::kPart);
  const ScopedTimer slide_timer(update_.timings, Module::kMarginalization);
  window_.slide();
}

/// With a wrong calibration, the states of the window are far from the true ones, and its prior is
/// linearized at the wrong point: it starts anew, for which vision and measured depth are needed.
void Estimator::free_calibration(Timestamp now) {
  if (monitor_.status() == OdometryStatus::kDeadReckoning) return;
  if (calibration_.awaits_alignment()) {
    const std::optional<RotationAlignment> alignment = start_.align_rotations(window(), now, imu_);
    if (alignment && calibration_.align(*alignment)) return restart_with_calibration(alignment->gyro_bias);
  }
  if (calibration_found_ && monitor_.can_restart(window())) restart_with_calibration(newest_.gyro_bias);
}

/// With the newest frame, at the same pose of its camera. Gravity and biases were estimated with the
/// calibration of the rig: gravity is uncertain, and the bias of the accelerometer is forgotten.
/// @param gyro_bias known without that calibration, or hardly affected by it
void Estimator::restart_with_calibration(const Eigen::Vector3d& gyro_bias) {
  const Pose T_before_after = product(window().T_b_c, calibration_.calibrated_window().T_b_c.inverse());
  NavState previous = previous_;
  previous.T_w_b = product(previous.T_w_b, T_before_after);
  const bool had_frame = !window_.empty();
  const std::int64_t id = had_frame ? window().frames.back().id : 0;
  std::vector<Landmark> landmarks = landmarks_of_newest(window(), calibration_.calibrated_window().lens);
  forget_calibrated_gravity(window_.states());
  restart(window().gravity_w);
  monitor_.calibration_changed();
  newest_.T_w_b = product(newest_.T_w_b, T_before_after);
  origin_ = in_frame(origin_, T_before_after);
  newest_.gyro_bias = gyro_bias;
  newest_.accel_bias.setZero();
  previous_ = previous;
  if (!had_frame) return;
  start_.begin({.id = id, .state = newest_, .time_offset_s = window().time_offset_s}, calibration_, imu_,
               window_.states());
  window_.states().landmarks = std::move(landmarks);
}

/// Clears the window; the next frame starts at the last valid pose, so the world frame is preserved, with the
/// error of that pose.
/// @param gravity_w before the solve that failed; an estimated one is kept with its covariance
void Estimator::restart(const Eigen::Vector3d& gravity_w) {
  window_.restart(WindowStart::restarted(window(), gravity_w, calibration_));
  if (newest_covariance_) origin_ = {newest_.T_w_b, newest_covariance_->pose()};
  newest_.v_w.setZero();
  previous_ = newest_;
  newest_covariance_.reset();
  calibration_found_ = false;
  calibration_.window_restarted();
  monitor_.window_restarted();
}

void Estimator::report(const NavState& state) {
  const Window& window = window_.states();
  update_.state = state;
  update_.T_w_c = state.T_w_b * window.T_b_c;
  update_.status = monitor_.status();
  update_.reason = monitor_.reason();
  update_.segment = monitor_.segment();
  update_.inertial = motion_state().inertial;
  update_.time_offset_s = window.time_offset_s;
  update_.depth_scale = window.depth_scale;
  update_.lens = window.lens;
  update_.agrees_with_rig = window.agrees_with_rig;
  update_.aligned_rotation = calibration_.aligned_rotation();
  update_.imu_noise = monitor_.imu_noise_factors();
  if (window.gravity_covariance) update_.q_level_w = level_rotation(window.gravity_w);
}

}  // namespace stillpoint
