// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/sliding_window.h"

#include <utility>

#include "core/backend/health/inertial_interval.h"
#include "core/backend/reference/ceres_solver.h"
#include "core/backend/solvers/schur_solver.h"
#include "core/backend/solvers/window_problem.h"
#include "core/backend/start/depth_initialization.h"
#include "core/backend/start/initial_prior.h"
#include "core/backend/window/landmark_tracks.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

/// Largest bias change from the linearization point for which the first-order correction is used.
constexpr double kRepropagateGyro = 0.01;  // [rad/s]
constexpr double kRepropagateAccel = 0.1;  // [m/s^2]

void repropagate_preintegrations(Window& window) {
  for (std::size_t i = 1; i < window.frames.size(); ++i) {
    std::optional<Preintegration>& imu = window.frames[i].from_previous;
    const NavState& state = window.frames[i - 1].state;
    if (!imu) continue;
    const bool far = (state.gyro_bias - imu->gyro_bias()).norm() > kRepropagateGyro ||
                     (state.accel_bias - imu->accel_bias()).norm() > kRepropagateAccel;
    if (far) imu->repropagate(state.gyro_bias, state.accel_bias);
  }
}

}  // namespace

std::unique_ptr<WindowSolver> make_window_solver(WindowSolverKind kind) {
  switch (kind) {
    case WindowSolverKind::kCeres:
      return std::make_unique<CeresSolver>();
    case WindowSolverKind::kSchur:
      return std::make_unique<SchurSolver>();
  }
  check_failed("a solver of this kind exists", __FILE__, __LINE__);
}

void mark_dynamic(std::span<const DynamicLabel> labels, Window& window) {
  auto landmark = window.landmarks.begin();
  for (const DynamicLabel& label : labels) {
    while (landmark != window.landmarks.end() && landmark->id < label.id) ++landmark;
    if (landmark == window.landmarks.end()) return;
    if (landmark->id != label.id) continue;
    if (label.reason == LabelReason::kStatic) restart_track(*landmark);
    const bool cleared = landmark->dynamic && label.label == LabelClass::kStable;
    landmark->dynamic = label.label != LabelClass::kStable;
    if (!cleared) continue;
    landmark->inverse_depth = 0.0;  // it was estimated before the point moved
    landmark->source = DepthSource::kNone;
  }
}

SlidingWindow::SlidingWindow(const BackendConfig& config, const Rig& rig, int seed, Window fresh)
    : config_(config),
      rig_(rig),
      seed_(static_cast<std::uint32_t>(seed)),
      solver_(make_window_solver(config.solver)),
      window_(std::move(fresh)),
      pixel_noise_(config.pixel_sigma_px, config.pixel_noise_scale) {}

void SlidingWindow::restart(Window fresh) {
  window_ = std::move(fresh);
  pixel_noise_ = {config_.pixel_sigma_px, config_.pixel_noise_scale};
  unusable_solves_ = 0;
}

void SlidingWindow::preintegrate(const InertialData& data, const ImuBuffer& imu, WindowFrame& next) {
  const NavState& last = window_.frames.back().state;
  const bool missing = data.samples.size() < 2;
  if (missing && (!window_.inertial || data.begin >= data.end)) return;
  next.imu_is_reliable = data.is_reliable;
  next.from_previous.emplace(data.noise, last.gyro_bias, last.accel_bias, window_.sample_pool.acquire());
  if (missing) {
    next.from_previous->integrate(constant_velocity_samples(last, window_.gravity_w, data.begin, data.end));
  } else {
    next.from_previous->integrate(data.samples);
  }
  next.gyro_b = next.from_previous->samples().back().gyro_b;
  next.accel_b = next.from_previous->samples().back().accel_b;
  if (next.imu_is_reliable && averages_imu(config_)) average_imu_at_exposure(imu, next);
}

void SlidingWindow::add_features(const TrackedFrame& frame) {
  oldest_motion_.reset();
  add_observations(frame, rig_, config_.depth, window_);
}

void SlidingWindow::discard_newest() { remove_newest_frame(window_); }

void SlidingWindow::choose_keyframe() {
  keyframe_ = is_second_newest_keyframe(window_, config_, rig_.camera.focal_px());
}

bool SlidingWindow::localize_newest() {
  WindowFrame& newest = window_.frames.back();
  if (window_.has_inertial_prediction()) return newest.from_previous.has_value();
  if (window_.newest() == 0 || !has_metric_scale()) return true;
  Pose prediction = newest.state.T_w_b;
  if (newest.from_previous && newest.imu_is_reliable) {
    const NavState& before = window_.frames[window_.frames.size() - 2].state;
    prediction.q = before.T_w_b.q * newest.from_previous->delta_q(before.gyro_bias);
  }
  const CameraPoseOptions options{.inlier_threshold = kLocalizationInlier_px / rig_.camera.focal_px(),
                                  .seed = seed_ + static_cast<std::uint32_t>(newest.id)};
  known_points_ = known_points(window_, config_.depth, std::move(known_points_));
  const std::optional<CameraPose> found =
      estimate_camera_pose(known_points_, product(prediction, window_.T_b_c), options);
  newest.state.T_w_b = found ? product(found->T_w_c, window_.T_b_c.inverse()) : prediction;
  return found.has_value();
}

void SlidingWindow::prepare_solve() {
  repropagate_preintegrations(window_);
  if (has_metric_scale()) initialize_depths(config_, rig_.camera.focal_px(), window_);
}

SlidingWindow::Solution SlidingWindow::solve(const Calibration& calibration) {
  Solution solution;
  const double focal_px = rig_.camera.focal_px();
  const Pose oldest = window_.frames.front().state.T_w_b;
  solution.report = solver_->solve(window_, pixel_noise_.applied_to(config_), focal_px);
  unusable_solves_ = solution.report.usable ? 0 : unusable_solves_ + 1;
  solution.at_bound = calibration.limit(window_);
  if (!window_.inertial) restore_gauge(oldest, config_, window_);
  if (config_.covariance && solution.report.usable) solution.covariance = covariance(keyframe_ && is_full());
  if (solution.covariance) oldest_motion_ = solution.covariance->oldest_motion;
  if (pixel_noise_.is_constant()) return solution;
  if (const auto variance = error_monitor_.measure(window_, focal_px)) pixel_noise_.observe(*variance);
  return solution;
}

std::optional<WindowCovariance> SlidingWindow::covariance(bool oldest_motion) {
  return solver_->covariance(window_, pixel_noise_.applied_to(config_), rig_.camera.focal_px(),
                             oldest_motion);
}

void SlidingWindow::slide() {
  if (!is_full()) return;
  if (!has_metric_scale()) {
    keyframe_ ? remove_oldest_frame(window_) : remove_second_newest_frame(window_);
    window_.prior = initial_prior(window_, config_);
  } else if (keyframe_) {
    LinearPrior prior = solver_->marginalize_oldest(window_, pixel_noise_.applied_to(config_),
                                                    rig_.camera.focal_px(), std::move(discarded_prior_));
    add_calibration_walk(config_, window_.agrees_with_rig,
                         seconds_between(window_.frames[0].state.t, window_.frames[1].state.t), prior);
    remove_marginalized_information(config_, window_);
    remove_oldest_frame(window_);
    discarded_prior_ = std::exchange(window_.prior, std::move(prior));
  } else {
    window_.prior = marginalizer_.remove(window_.newest() - 1, std::move(window_.prior));
    remove_second_newest_frame(window_);
  }
  // Nothing connected the removed frame to the others: fix the gauge at the new oldest frame.
  if (window_.prior.empty()) window_.prior = initial_prior(window_, config_);
}

double SlidingWindow::residual_sigma() const { return pixel_noise_.sigma_px() / rig_.camera.focal_px(); }

double SlidingWindow::white_sigma() const { return pixel_noise_.white_px() / rig_.camera.focal_px(); }

}  // namespace stillpoint
