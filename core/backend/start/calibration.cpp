// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/start/calibration.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/backend/start/initial_prior.h"
#include "core/backend/window/landmark_tracks.h"
#include "core/geometry/covariance.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/so3.h"
#include "core/types/rig_tolerance.h"

namespace stillpoint {
namespace {

constexpr int kAlignedDegreesOfFreedom = 4;  // rotation and time offset
/// Another depth scale is doubted until the inertial noise is about known (InertialNoise): recorded inertial
/// data (V1_03, from 20 and 60 s) contradicted a true scale by up to 5.6 standard deviations in its first
/// second, and by less than 2 later.
constexpr double kNoiseKnown_s = 1.5;
/// Largest ratio of the variance of a depth scale to that of its prior at which inertial data says something
/// about it. Scales 10 and 20 % off were found at .02 to .2 (home1-3, halfsphere, room1); a robot on a floor
/// (market, office_laps) stays above .4, and 3 s of a clipped accelerometer turned .5 into a scale 14 % off.
constexpr double kObserved = 0.25;
/// Squared difference, in variances, above which a scale is another one: 99 % of one degree of freedom. With
/// 99.99 % a scale 5 % off was kept for 8 s beside a noisy IMU (walking_xyz, fault rig:seed=2: 0.0094 m, with
/// 99 % 0.0058 m); V1_03, room1 and room3 with an exact rig are the same in all digits.
constexpr double kOtherScale = 6.63;
/// Likewise of a lens, with four degrees of freedom. With 99.99 % (and the tolerances of 58926c1) the ATE of
/// 34 rigs with imperfections, on 13 recorded motions and walking_xyz, was 1.22 times as large, the false
/// confidence 2.3 % instead of 0.
constexpr double kOtherLens = 13.28;
/// Squared difference, in variances, below which a value that differed is again that of the rig.
constexpr double kLikeRig = 4.0;
constexpr double kAveragingHalfWidth_s = 0.02;  // as far as samples are available after the newest exposure

/// Limits `value` to [center - bound, center + bound]. @return whether it was outside
bool clamp_around(double center, double bound, double& value) {
  const double limited = std::clamp(value, center - bound, center + bound);
  const bool at_bound = limited != value;
  value = limited;
  return at_bound;
}

/// @return whether either part was outside of its bound
bool limit_extrinsics(const Pose& calibrated, const BackendConfig& config, Pose& T_b_c) {
  const Eigen::Vector3d translation = T_b_c.p - calibrated.p;
  const Eigen::Vector3d rotation = log_so3(calibrated.q.conjugate() * T_b_c.q);
  const bool translated = translation.norm() > config.extrinsics_bound_m;
  const bool rotated = rotation.norm() > config.extrinsics_bound_rad;
  if (translated) T_b_c.p = calibrated.p + config.extrinsics_bound_m * translation.normalized();
  if (rotated) T_b_c.q = calibrated.q * exp_so3(config.extrinsics_bound_rad * rotation.normalized());
  return translated || rotated;
}

}  // namespace

Calibration::Calibration(const BackendConfig& config, bool uses_imu, const Rig& rig)
    : config_(config),
      uses_imu_(uses_imu),
      rig_(rig),
      depth_scale_prior_(config.depth.scale_sigma),
      depth_scale_confirmed_(config.depth.scale_sigma) {}

Window Calibration::calibrated_window() const {
  Window window;
  window.T_b_c = rig_.T_b_c;
  window.time_offset_s = rig_.time_offset_s;
  window.time_offset_model = config_.time_offset_model;
  window.agrees_with_rig = {
      .extrinsics = starts_with_rig() && config_.estimate_extrinsics && !extrinsics_found_,
      .depth_scale = compares_depth_scale() && !depth_scale_found_,
      .lens = compares_lens() && !lens_found_};
  if (extrinsics_found_) window.T_b_c = *extrinsics_found_;
  if (lens_found_) window.lens = lens_found_->value;
  if (depth_scale_found_) window.depth_scale = depth_scale_found_->value;
  if (time_offset_found_s_) window.time_offset_s = *time_offset_found_s_;
  if (!is_aligned_otherwise()) return window;
  window.T_b_c.q = rotation_alignment_->q_b_c;
  window.time_offset_s = rotation_alignment_->time_offset_s;
  window.is_realigned = true;
  window.agrees_with_rig.extrinsics = false;
  return window;
}

LinearPrior Calibration::prior() const {
  const Window window = calibrated_window();
  BackendConfig config = config_;
  config.depth.scale_sigma =
      std::min(depth_scale_prior_, depth_scale_found_ ? depth_scale_found_->sigma : depth_scale_prior_);
  LinearPrior prior = is_aligned_otherwise()
                          ? aligned_calibration_prior(window, config, rotation_alignment_->covariance)
                          : calibration_prior(window, config);
  if (lens_found_) prior.jacobian.bottomRightCorner<4, 4>() = inverse_root(lens_found_->covariance);
  return prior;
}

bool Calibration::awaits_alignment() const {
  return config_.initializer.align_rotations && uses_imu_ && config_.depth.usage != DepthUsage::kOff &&
         !rotation_alignment_;
}

bool Calibration::align(const RotationAlignment& alignment) {
  if (alignment.is_of_offset_alone) {
    if (agrees_with_rig(alignment.rig_contradiction, 1)) return false;
    time_offset_found_s_ = alignment.time_offset_s;
  } else {
    rotation_alignment_ = alignment;
    if (!is_aligned_otherwise()) return false;
  }
  compared_since_.reset();
  extrinsics_found_.reset();
  depth_scale_found_.reset();  // with the rotation and the time offset of the rig
  depth_scale_confirmed_ = config_.depth.scale_sigma;
  lens_found_.reset();
  return true;
}

std::optional<AlignedRotation> Calibration::aligned_rotation() const {
  if (!rotation_alignment_) return std::nullopt;
  return AlignedRotation{.difference_rad = rotation_alignment_->q_b_c.angularDistance(rig_.T_b_c.q),
                         .sigma_rad = largest_sigma(rotation_alignment_->covariance.topLeftCorner<3, 3>()),
                         .deviations = rotation_alignment_->rotation_deviations};
}

bool Calibration::agrees_with_rig(double contradiction, int degrees_of_freedom) const {
  return chi_square_tail(contradiction, degrees_of_freedom) >=
         1.0 - config_.calibration_agreement_probability;
}

bool Calibration::is_aligned_otherwise() const {
  return rotation_alignment_ && (rotation_alignment_->is_certain || config_.estimate_extrinsics) &&
         !agrees_with_rig(rotation_alignment_->rig_contradiction, kAlignedDegreesOfFreedom);
}

void Calibration::compare_depth_scale(double step, double variance, Window& window) {
  bool& agrees = window.agrees_with_rig.depth_scale;
  const Timestamp now = window.frames.back().state.t;
  if (!compared_since_) compared_since_ = now;
  const double early = agrees ? kNoiseKnown_s / std::max(seconds_between(*compared_since_, now), 1e-3) : 0.0;
  const double difference = 1.0 / window.depth_scale - 1.0 + step;
  const double tolerated = rig_tolerance::kDepthScale * rig_tolerance::kDepthScale;
  const double contradiction = difference * difference / (variance * (1.0 + early * early) + tolerated);
  const bool observed = variance <= kObserved * depth_scale_prior_ * depth_scale_prior_;
  if (agrees && observed && early <= 1.0 && difference * difference <= variance)
    depth_scale_confirmed_ = std::min(depth_scale_confirmed_, std::sqrt(variance + tolerated));
  agrees = !observed || contradiction < (agrees ? kOtherScale : kLikeRig);
  if (agrees) window.depth_scale = 1.0;
  depth_scale_found_.reset();
  if (agrees) return;
  depth_scale_found_ = {window.depth_scale, std::sqrt(variance)};
  depth_scale_confirmed_ = config_.depth.scale_sigma;
}

void Calibration::window_restarted() {
  compared_since_.reset();
  depth_scale_prior_ = depth_scale_confirmed_;
}

/// d^T (C + S)^-1 d with d the difference of the converged estimate from the rig and S what a calibration is
/// good to. Until rotations are aligned, a camera that is turned on the body looks like one with another
/// center.
void Calibration::compare_lens(const Eigen::Vector4d& step, const Eigen::Matrix4d& covariance,
                               Window& window) {
  bool& agrees = window.agrees_with_rig.lens;
  const Eigen::Vector4d difference = window.lens + step;
  Eigen::Matrix4d tolerated = covariance;
  tolerated.diagonal() += Eigen::Vector4d::Map(rig_tolerance::kLens.data()).cwiseAbs2();
  if (awaits_alignment())
    tolerated.diagonal().tail<2>().array() += config_.extrinsics_sigma_rad * config_.extrinsics_sigma_rad;
  const double contradiction = difference.dot(solve_symmetric(tolerated, difference));
  agrees = contradiction < (agrees ? kOtherLens : kLikeRig);
  if (agrees) set_lens(Eigen::Vector4d::Zero(), window);
  lens_found_.reset();
  if (!agrees) lens_found_ = {window.lens, covariance};
}

void Calibration::compare_extrinsics(const Vector6& step, const Matrix6& covariance, Window& window) {
  Matrix6 tolerated = covariance;
  tolerated.diagonal().head<3>().array() += rig_tolerance::kLever_m * rig_tolerance::kLever_m;
  tolerated.diagonal().tail<3>().array() += rig_tolerance::kRotation_rad * rig_tolerance::kRotation_rad;
  const double contradiction = step.dot(solve_symmetric(tolerated, step));
  window.agrees_with_rig.extrinsics &= agrees_with_rig(contradiction, local_size(BlockKind::kExtrinsics));
  extrinsics_found_.reset();
  if (!window.agrees_with_rig.extrinsics) extrinsics_found_ = window.T_b_c;
}

void Calibration::compare_with_rig(const RigStep& step, const StateCovariance& covariance, Window& window) {
  if (compares_lens() && covariance.lens(0, 0) > 0.0) compare_lens(step.lens, covariance.lens, window);
  if (compares_depth_scale() && covariance.depth_scale > 0.0)
    compare_depth_scale(step.depth_scale, covariance.depth_scale, window);
  if (!awaits_alignment()) compare_extrinsics(step.extrinsics, covariance.extrinsics, window);
}

CalibrationAtBound Calibration::limit(Window& window) const {
  return {.time_offset = clamp_around(rig_.time_offset_s, config_.time_offset_bound_s, window.time_offset_s),
          .extrinsics = limit_extrinsics(rig_.T_b_c, config_, window.T_b_c),
          .depth_scale = clamp_around(1.0, config_.depth.scale_bound, window.depth_scale)};
}

bool has_converged(const AgreesWithRig& constant, const RigStep& step, const StateCovariance& covariance) {
  constexpr double kSmall = 0.25 * 0.25;
  const bool has_scale =
      constant.depth_scale || step.depth_scale * step.depth_scale <= kSmall * covariance.depth_scale;
  const bool has_lens =
      constant.lens || (step.lens.cwiseAbs2().array() <= kSmall * covariance.lens.diagonal().array()).all();
  return has_scale && has_lens;
}

void average_imu_at_exposure(const ImuBuffer& imu, WindowFrame& frame) {
  const Timestamp exposure = after(frame.state.t, frame.time_offset_s);
  const std::optional<ImuSample> mean = imu.mean_around(exposure, kAveragingHalfWidth_s);
  if (!mean) return;
  frame.gyro_b = mean->gyro_b;
  frame.accel_b = mean->accel_b;
}

void add_calibration_walk(const BackendConfig& config, const AgreesWithRig& agrees, double seconds,
                          LinearPrior& prior) {
  const double root = std::sqrt(seconds);
  const double m = root * config.extrinsics_walk_m;
  const double rad = root * config.extrinsics_walk_rad;
  add_random_step(BlockKind::kTimeOffset, std::array{root * config.time_offset_walk}, prior);
  if (!agrees.extrinsics) add_random_step(BlockKind::kExtrinsics, std::array{m, m, m, rad, rad, rad}, prior);
}

}  // namespace stillpoint
