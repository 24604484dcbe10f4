// SPDX-License-Identifier: BSD-3-Clause
/// Configuration of the estimator: window, solver, depth, initialization. Defaults are those of
/// Dynamic-VINS, except for checks, limits and priors that it lacks; its config disables them.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

/// `kFixed`: a measured depth is a constant of the solve; `kWeighted`: it is a residual; `kOff`: unused.
enum class DepthUsage { kOff, kFixed, kWeighted };
constexpr auto enum_names(DepthUsage) {
  return EnumNames<DepthUsage, 3>{
      {{DepthUsage::kOff, "off"}, {DepthUsage::kFixed, "fixed"}, {DepthUsage::kWeighted, "weighted"}}};
}

/// `kWindow`: visual-inertial alignment once the window is full; `kInstant`: as soon as it covers
/// `min_span_s`; `kMonocular`: structure from motion without depth, then alignment including the scale.
enum class InitializerKind { kWindow, kInstant, kMonocular };
constexpr auto enum_names(InitializerKind) {
  return EnumNames<InitializerKind, 3>{{{InitializerKind::kWindow, "window"},
                                        {InitializerKind::kInstant, "instant"},
                                        {InitializerKind::kMonocular, "monocular"}}};
}

enum class WindowSolverKind { kCeres, kSchur };
constexpr auto enum_names(WindowSolverKind) {
  return EnumNames<WindowSolverKind, 2>{
      {{WindowSolverKind::kCeres, "ceres"}, {WindowSolverKind::kSchur, "schur"}}};
}

/// `kFixed`: the world is level by initialization, and the poses turn while the attitude becomes more
/// accurate (published system); `kEstimated`: the direction of gravity is a state, and the world is fixed by
/// the first pose.
enum class GravityModel { kFixed, kEstimated };
constexpr auto enum_names(GravityModel) {
  return EnumNames<GravityModel, 2>{
      {{GravityModel::kFixed, "fixed"}, {GravityModel::kEstimated, "estimated"}}};
}

/// `kPublished`: the prior is linearized again at each slide, calibration is no part of it, and the
/// information of a landmark enters the prior in full each time that its first frame leaves. `kConsistent`:
/// first-estimates Jacobians, calibration is part of the prior, the information of landmarks is shared
/// between the priors that contain them, and the first pose is exact.
enum class PriorModel { kPublished, kConsistent };
constexpr auto enum_names(PriorModel) {
  return EnumNames<PriorModel, 2>{
      {{PriorModel::kPublished, "published"}, {PriorModel::kConsistent, "consistent"}}};
}

/// How the offset between the clocks of camera and IMU enters the residuals. `kBearing`: bearings are shifted
/// along their image velocity to the time of the state (Qin and Shen 2018); `kInertial`: states are defined
/// at the exposures, and the inertial residual shifts them to the ends of its preintegration.
enum class TimeOffsetModel { kBearing, kInertial };
constexpr auto enum_names(TimeOffsetModel) {
  return EnumNames<TimeOffsetModel, 2>{
      {{TimeOffsetModel::kBearing, "bearing"}, {TimeOffsetModel::kInertial, "inertial"}}};
}

/// How measured depth enters the estimate.
struct DepthConfig {
  DepthUsage usage = DepthUsage::kFixed;
  double min_m = 0.3;                  ///< smaller measured depths are ignored
  double max_m = 8.0;                  ///< larger measured depths are not used to initialize a landmark
  double inverse_sigma = 0.003;        ///< standard deviation of 1/depth [1/m]: sigma_Z = this * Z^2
  double outlier_sigmas = 2.0;         ///< kWeighted: bound of the depth residual, in standard deviations
  double agreement_px = 10.0;          ///< largest reprojection error of a depth accepted from one view
  double agreement_probability = 0.0;  ///< > 0: by the covariance of that error instead
  double max_scale_error = 0.0;  ///< depth whose scale differs by more from that of known landmarks is not
                                 ///< used; 0 = no check
  double max_landmark_depth_m = 100.0;  ///< landmarks triangulated or estimated farther away are discarded
  bool estimate_scale = false;          ///< ratio of measured to true depth; constant 1 without an IMU
  double scale_sigma = 0.1;             ///< prior standard deviation around 1
  double scale_walk = 0.0;              ///< random walk [1/sqrt(s)]
  double scale_bound = 0.3;             ///< largest deviation from 1
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DepthConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("usage", config.usage);
  field("min_m", config.min_m, 0.01, 10.0);
  field("max_m", config.max_m, 0.1, 100.0);
  field("inverse_sigma", config.inverse_sigma, 1e-5, 1.0);
  field("outlier_sigmas", config.outlier_sigmas, 0.1, 1000.0);
  field("agreement_px", config.agreement_px, 0.1, 100.0);
  field("agreement_probability", config.agreement_probability, 0.0, 0.999999);
  field("max_scale_error", config.max_scale_error, 0.0, 1.0);
  field("max_landmark_depth_m", config.max_landmark_depth_m, 10.0, 10000.0);
  field("estimate_scale", config.estimate_scale);
  field("scale_sigma", config.scale_sigma, 1e-6, 1.0);
  field("scale_walk", config.scale_walk, 0.0, 1.0);
  field("scale_bound", config.scale_bound, 1e-3, 0.9);
}

/// Initialization, and the uncertainty of the initial state. Position and heading of frame 0 fix the gauge.
struct InitializerConfig {
  InitializerKind kind = InitializerKind::kWindow;
  double min_span_s = 0.3;        ///< instant: shortest time span from which gravity is estimated
  double gyro_bias_sigma = 0.02;  ///< prior standard deviation [rad/s]
  double accel_bias_sigma = 0.1;  ///< prior standard deviation [m/s^2]
  bool align_rotations = false;   ///< estimated extrinsics and the time offset in the first 3 s, by rotations
                                  ///< alone; see core/backend/start/rotation_alignment.h
  double gravity_tolerance = 1.0;  ///< largest accepted error of the unconstrained gravity norm [m/s^2]
  int min_common_features = 30;    ///< monocular: in the initial frame pair. Qin et al. 2018, Sec. V-A
  double min_parallax_px = 20.0;   ///< monocular: their mean rotation-compensated parallax; same source
  double max_scale_sigma = 0.1;    ///< monocular: of the scale, relative; a less certain one is rejected
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, InitializerConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("kind", config.kind);
  field("min_span_s", config.min_span_s, 0.1, 10.0);
  field("gyro_bias_sigma", config.gyro_bias_sigma, 1e-5, 10.0);
  field("accel_bias_sigma", config.accel_bias_sigma, 1e-5, 10.0);
  field("align_rotations", config.align_rotations);
  field("gravity_tolerance", config.gravity_tolerance, 0.01, 9.0);
  field("min_common_features", config.min_common_features, 10, 1000);
  field("min_parallax_px", config.min_parallax_px, 1.0, 200.0);
  field("max_scale_sigma", config.max_scale_sigma, 1e-3, 10.0);
}

/// Zero-velocity factor for frames at rest; see core/backend/health/standstill.h. Not in the paper.
struct ZeroVelocityConfig {
  bool enabled = false;
  double statistic = 12.0;        ///< largest statistic of inertial samples at rest; its mean is 6 at rest
  double static_px = 1.0;         ///< largest motion of a static feature over 0.2 s or more
  double min_static_ratio = 0.1;  ///< of the features; the others may belong to moving objects
  double sigma_m_per_s = 0.002;   ///< standard deviation of the velocity at rest
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ZeroVelocityConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("enabled", config.enabled);
  field("statistic", config.statistic, 0.1, 1e6);
  field("static_px", config.static_px, 0.01, 100.0);
  field("min_static_ratio", config.min_static_ratio, 0.01, 1.0);
  field("sigma_m_per_s", config.sigma_m_per_s, 1e-4, 10.0);
}

/// Upper limit of `window_size`.
inline constexpr int kMaxWindowSize = 40;

struct BackendConfig {
  double rate_hz = 10.0;               ///< rate of the frames that enter the window [Hz]; 0 = every frame
  int window_size = 10;                ///< number of states before the newest one
  double keyframe_parallax_px = 10.0;  ///< mean feature displacement that triggers a keyframe
  int keyframe_min_tracked = 20;       ///< fewer static features shared with the last keyframe trigger one
  double keyframe_min_shared_ratio = 0.5;  ///< same, relative to all static features; 0 = off, as in the
                                           ///< published code (there dynamic features add parallax)
  double pixel_sigma_px = 1.5;             ///< standard deviation of a reprojection residual
  double feature_sigma_px = 1.5;        ///< same of a feature position, for decisions: triangulation, inliers
                                        ///< of a pose, moving consistency
  double reprojection_error_px = 0.0;   ///< nominal median, by which pixel_sigma_px is scaled; 0 = off
  double min_pixel_noise_factor = 1.0;  ///< limits of that scale
  double max_pixel_noise_factor = 4.0;  ///< same
  double cauchy_scale = 1.0;            ///< scale of the Cauchy loss, in standard deviations
  WindowSolverKind solver = WindowSolverKind::kCeres;  ///< both minimize the same residuals
  int max_iterations = 8;
  double function_tolerance = 1e-6;      ///< relative change of the cost at which the solve stops
  double keyframe_max_interval_s = 5.0;  ///< limits the length of a preintegration
  GravityModel gravity = GravityModel::kFixed;
  PriorModel prior =
      PriorModel::kPublished;  ///< once the IMU is initialized; before and without one published
  bool covariance = false;     ///< compute the covariance of the newest state with each frame
  bool bias_steps = false;     ///< follow steps of the biases, which their random walk does not allow for
  bool estimate_time_offset = true;
  TimeOffsetModel time_offset_model = TimeOffsetModel::kBearing;
  double time_offset_sigma_s = 0.01;  ///< prior standard deviation around the calibrated value
  double time_offset_walk = 0.0;      ///< random walk in the consistent prior [s/sqrt(s)]
  double time_offset_bound_s = 1.0;   ///< largest deviation from the calibrated value; none is published
  bool estimate_extrinsics = false;
  double extrinsics_sigma_m = 0.02;    ///< prior standard deviation around the calibrated value
  double extrinsics_sigma_rad = 0.02;  ///< same for the rotation
  double extrinsics_walk_m = 0.0;      ///< random walk in the consistent prior [m/sqrt(s)]
  double extrinsics_walk_rad = 0.0;    ///< same for the rotation [rad/sqrt(s)]
  double extrinsics_bound_m = 10.0;    ///< largest deviation from the calibrated value; none is published
  double extrinsics_bound_rad = 3.14;  ///< same for the rotation
  double calibration_agreement_probability = 0.0;  ///< > 0: estimated extrinsics and depth scale have the
                                                   ///< values of the rig until the data contradicts those
                                                   ///< with this probability
  double max_dead_reckoning_s = 6.0;               ///< without vision; then the pose is lost
  double max_relocalization_s = 1.0;               ///< with a view after a loss; then a new world begins
  ZeroVelocityConfig zero_velocity;
  DepthConfig depth;
  InitializerConfig initializer;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, BackendConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("rate_hz", config.rate_hz, 0.0, 1000.0);
  field("window_size", config.window_size, 4, kMaxWindowSize);
  field("keyframe_parallax_px", config.keyframe_parallax_px, 0.1, 200.0);
  field("keyframe_min_tracked", config.keyframe_min_tracked, 0, 1000);
  field("keyframe_min_shared_ratio", config.keyframe_min_shared_ratio, 0.0, 1.0);
  field("pixel_sigma_px", config.pixel_sigma_px, 0.05, 20.0);
  field("feature_sigma_px", config.feature_sigma_px, 0.05, 20.0);
  field("reprojection_error_px", config.reprojection_error_px, 0.0, 20.0);
  field("min_pixel_noise_factor", config.min_pixel_noise_factor, 0.01, 1.0);
  field("max_pixel_noise_factor", config.max_pixel_noise_factor, 1.0, 1000.0);
  field("cauchy_scale", config.cauchy_scale, 0.01, 100.0);
  field("solver", config.solver);
  field("max_iterations", config.max_iterations, 1, 100);
  field("function_tolerance", config.function_tolerance, 1e-12, 0.1);
  field("keyframe_max_interval_s", config.keyframe_max_interval_s, 0.05, 10.0);
  field("gravity", config.gravity);
  field("prior", config.prior);
  field("covariance", config.covariance);
  field("bias_steps", config.bias_steps);
  field("estimate_time_offset", config.estimate_time_offset);
  field("time_offset_model", config.time_offset_model);
  field("time_offset_sigma_s", config.time_offset_sigma_s, 1e-6, 1.0);
  field("time_offset_walk", config.time_offset_walk, 0.0, 1.0);
  field("time_offset_bound_s", config.time_offset_bound_s, 1e-3, 1.0);
  field("estimate_extrinsics", config.estimate_extrinsics);
  field("extrinsics_sigma_m", config.extrinsics_sigma_m, 1e-6, 1.0);
  field("extrinsics_sigma_rad", config.extrinsics_sigma_rad, 1e-6, 1.0);
  field("extrinsics_walk_m", config.extrinsics_walk_m, 0.0, 1.0);
  field("extrinsics_walk_rad", config.extrinsics_walk_rad, 0.0, 1.0);
  field("extrinsics_bound_m", config.extrinsics_bound_m, 1e-3, 10.0);
  field("extrinsics_bound_rad", config.extrinsics_bound_rad, 1e-3, 3.14);
  field("calibration_agreement_probability", config.calibration_agreement_probability, 0.0, 0.999999);
  field("max_dead_reckoning_s", config.max_dead_reckoning_s, 0.0, 1000.0);
  field("max_relocalization_s", config.max_relocalization_s, 0.0, 1000.0);
  field("zero_velocity", config.zero_velocity);
  field("depth", config.depth);
  field("initializer", config.initializer);
}

}  // namespace stillpoint
