// SPDX-License-Identifier: BSD-3-Clause
/// Configuration of the estimator: window, solver, depth, initialization. The defaults are those of the
/// program, see odometry_config.h. The field lists explain the keys.
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
  DepthUsage usage = DepthUsage::kWeighted;
  double min_m = 0.3;
  double max_m = 8.0;
  double inverse_sigma = 0.003;
  double outlier_sigmas = 5.0;
  double agreement_probability = 0.99999;
  double max_scale_error = 0.04;  ///< a sensor whose scale changes must not change that of the world
  double max_landmark_depth_m = 100.0;
  bool estimate_scale = true;  ///< depth of real sensors is up to 22 % short, the inertial scale 0.6 % off
  double scale_sigma = 0.1;
  double scale_bound = 0.3;

  // Not keys: no config changes them.
  double agreement_px =
      10.0;  ///< largest reprojection error of a depth accepted from one view; published code
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DepthConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("usage", config.usage,
        FieldInfo{
            .text =
                "Whether a measured depth is a constant of the solve (published), a residual with its noise, "
                "or unused.",
            .paper = "II"});
  field("min_m", config.min_m, FieldInfo{"Smaller measured depths are ignored.", "m", 0.01, 10.0});
  field("max_m", config.max_m,
        FieldInfo{"Larger measured depths do not initialize a landmark.", "m", 0.1, 100.0});
  field(
      "inverse_sigma", config.inverse_sigma,
      FieldInfo{"Standard deviation of a measured inverse depth; that of the depth is this times its square.",
                "1/m", 1e-5, 1.0});
  field("outlier_sigmas", config.outlier_sigmas,
        FieldInfo{"Usage weighted: largest depth residual, in standard deviations.", "sigma", 0.1, 1000.0});
  field("agreement_probability", config.agreement_probability,
        FieldInfo{
            "Probability that a correct measured depth is accepted from one view, by the covariance of its "
            "reprojection error; 0 = below 10 px, as published.",
            "", 0.0, 0.999999});
  field("max_scale_error", config.max_scale_error,
        FieldInfo{"Depth whose scale differs by more from that of known landmarks is not used; 0 = no check.",
                  "", 0.0, 1.0});
  field("max_landmark_depth_m", config.max_landmark_depth_m,
        FieldInfo{"Landmarks that are triangulated or estimated farther away are discarded.", "m", 10.0,
                  10000.0});
  field("estimate_scale", config.estimate_scale,
        FieldInfo{.text = "Whether the ratio of measured to true depth is estimated; 1 without an IMU."});
  field("scale_sigma", config.scale_sigma,
        FieldInfo{"Prior standard deviation of the depth scale around 1.", "", 1e-6, 1.0});
  field("scale_bound", config.scale_bound,
        FieldInfo{"Largest deviation of the depth scale from 1.", "", 1e-3, 0.9});
}

/// Initialization, and the uncertainty of the initial state. Position and heading of frame 0 fix the gauge.
struct InitializerConfig {
  InitializerKind kind = InitializerKind::kInstant;
  double gyro_bias_sigma = 0.02;
  double accel_bias_sigma = 0.1;
  bool align_rotations =
      true;  ///< else a rotation far off is not found, or taken for the center of the camera
  double max_scale_sigma = 0.1;

  // Not keys: no config changes them.
  double min_span_s = 0.3;  ///< instant: shortest time span from which gravity is estimated
  double gravity_tolerance =
      1.0;  ///< largest accepted error of the unconstrained gravity norm [m/s^2]; VINS-Mono
  int min_common_features = 30;   ///< monocular: in the initial frame pair. Qin et al. 2018, Sec. V-A
  double min_parallax_px = 20.0;  ///< monocular: their mean rotation-compensated parallax; same source. Slow
                                  ///< rotation in place never reaches it
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, InitializerConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("kind", config.kind,
        FieldInfo{
            .text =
                "When inertial states are initialized: once the window is full, as soon as it covers 0.3 s, "
                "or, without depth, by structure from motion and alignment including the scale.",
            .paper = "II"});
  field("gyro_bias_sigma", config.gyro_bias_sigma,
        FieldInfo{"Prior standard deviation of the gyroscope bias.", "rad/s", 1e-5, 10.0});
  field("accel_bias_sigma", config.accel_bias_sigma,
        FieldInfo{"Prior standard deviation of the accelerometer bias.", "m/s^2", 1e-5, 10.0});
  field("align_rotations", config.align_rotations,
        FieldInfo{
            .text =
                "Whether the rotation of the camera on the body and the time offset are found in the first 3 "
                "s by rotations alone. Extrinsics that these contradict are estimated from then on."});
  field(
      "max_scale_sigma", config.max_scale_sigma,
      FieldInfo{"Kind monocular: largest relative standard deviation of an accepted scale.", "", 1e-3, 10.0});
}

/// Upper limit of `window_size`.
inline constexpr int kMaxWindowSize = 40;

struct BackendConfig {
  double rate_hz = 0.0;  ///< every frame is optimized
  int window_size = 10;
  double keyframe_parallax_px = 10.0;
  double keyframe_min_shared_ratio =
      0.5;  ///< else features behind a passing person are lost without a keyframe
  double keyframe_max_interval_s = 0.5;  ///< limits the preintegration interval while the camera is at rest
  double pixel_sigma_px = 0.25;          ///< a prior that counts repeatedly needs a larger one
  double pixel_noise_scale = 1.0;        ///< the noise of the residuals, whatever the camera
  double cauchy_scale = 1.0;
  WindowSolverKind solver = WindowSolverKind::kSchur;  ///< the same minimum in a twentieth of the time
  int max_iterations = 4;  ///< as accurate as 8 when starting from the inertial prediction
  GravityModel gravity =
      GravityModel::kEstimated;  ///< else the world turns while tilt and accelerometer bias become known
  PriorModel prior = PriorModel::kConsistent;  ///< counts each observation once
  bool covariance = true;                      ///< of the newest state, with each frame
  bool bias_steps = true;  ///< else a sensor whose bias changes takes the estimate with it
  bool estimate_time_offset = true;
  TimeOffsetModel time_offset_model =
      TimeOffsetModel::kInertial;  ///< the state is at the exposure, not the bearings moved to the stamp
  double time_offset_sigma_s = 0.01;
  double time_offset_walk = 0.001;
  double time_offset_bound_s = 0.15;  ///< five times the search range of Kalibr; more means wrong time stamps
  bool estimate_extrinsics = false;
  bool estimate_lens = true;  ///< the focal length of consumer cameras is 2 % off, k1 0.05, the center 5 px
  double extrinsics_sigma_m = 0.02;
  double extrinsics_sigma_rad = 0.02;
  double extrinsics_bound_m = 0.1;  ///< more means a wrong rig
  double extrinsics_bound_rad = 0.2;
  double calibration_agreement_probability =
      0.9999;  ///< else what is not yet known of a true calibration moves the poses
  double max_dead_reckoning_s = 6.0;
  DepthConfig depth;
  InitializerConfig initializer;

  // Not keys: no config changes them.
  double extrinsics_walk_m = 0.0001;    ///< random walk in the consistent prior [m/sqrt(s)]: else what the
                                        ///< first seconds told stays, linearized at a wrong calibration
  double extrinsics_walk_rad = 0.0001;  ///< same for the rotation [rad/sqrt(s)]
  double max_relocalization_s = 1.0;  ///< after a loss, a new world begins when known landmarks are not found
                                      ///< for this long in a view, and in ten frames
  int keyframe_min_tracked =
      20;  ///< fewer static features shared with the last keyframe trigger one; VINS-Mono
  double feature_sigma_px = 1.5;  ///< standard deviation of a feature position, for decisions: triangulation,
                                  ///< inliers of a pose, moving consistency
  double function_tolerance =
      1e-6;  ///< relative change of the cost at which the solve stops; default of Ceres
};
/// Keys of the window and its keyframes.
template <class Visitor, class Config>
void visit_window_fields(Visitor&& field, Config& config) {
  field("rate_hz", config.rate_hz,
        FieldInfo{"Rate of the frames that enter the window; 0 = every frame.", "Hz", 0.0, 1000.0, "II"});
  field("window_size", config.window_size,
        FieldInfo{"States of the window before the newest one.", "frames", 4, kMaxWindowSize, "II"});
  field(
      "keyframe_parallax_px", config.keyframe_parallax_px,
      FieldInfo{
          "Mean displacement of the features since the last keyframe that makes a keyframe; px at the focal "
          "length.",
          "px", 0.1, 200.0});
  field("keyframe_min_shared_ratio", config.keyframe_min_shared_ratio,
        FieldInfo{
            "A smaller fraction of static features shared with the last keyframe makes a keyframe; 0 = fewer "
            "than 20 features only, as published (there dynamic features add parallax).",
            "", 0.0, 1.0});
  field("keyframe_max_interval_s", config.keyframe_max_interval_s,
        FieldInfo{
            "A longer time since the last keyframe makes a keyframe: limits the length of a preintegration.",
            "s", 0.05, 10.0});
}

/// Keys of the residuals and the solver.
template <class Visitor, class Config>
void visit_noise_fields(Visitor&& field, Config& config) {
  field("pixel_sigma_px", config.pixel_sigma_px,
        FieldInfo{"Standard deviation of a reprojection residual; px at the focal length.", "px", 0.05, 20.0,
                  "II"});
  field(
      "pixel_noise_scale", config.pixel_noise_scale,
      FieldInfo{"Factor on the pixel noise that the reprojection errors show, which replaces pixel_sigma_px "
                "while running; 0 = off.",
                "", 0.0, 100.0});
  field("cauchy_scale", config.cauchy_scale,
        FieldInfo{"Scale of the Cauchy loss of a reprojection residual.", "sigma", 0.01, 100.0});
  field(
      "solver", config.solver,
      FieldInfo{
          .text = "Ceres (the reference) or the built-in Schur complement; both minimize the same residuals.",
          .paper = "II"});
  field("max_iterations", config.max_iterations, FieldInfo{"Iterations of a solve.", "", 1, 100});
  field("gravity", config.gravity,
        FieldInfo{
            .text =
                "Whether the world is level by initialization (published), or the direction of gravity is a "
                "state and the first pose fixes the world."});
  field("prior", config.prior,
        FieldInfo{.text = "Marginalization prior: as published, or consistent, with "
                          "first-estimates Jacobians and each observation counted once.",
                  .paper = "II"});
  field("covariance", config.covariance,
        FieldInfo{.text = "Whether the covariance of the newest state is computed with each frame: for the "
                          "output, and for the gates, limits and bridged images that use it."});
  field(
      "bias_steps", config.bias_steps,
      FieldInfo{
          .text = "Whether steps of the biases, which their random walk does not allow for, are followed."});
}

/// Keys of estimated calibration.
template <class Visitor, class Config>
void visit_calibration_fields(Visitor&& field, Config& config) {
  field("estimate_time_offset", config.estimate_time_offset,
        FieldInfo{.text = "Whether the offset between the clocks of camera and IMU is estimated."});
  field("time_offset_model", config.time_offset_model,
        FieldInfo{
            .text = "Whether the time offset shifts bearings along their image velocity (Qin and Shen 2018, "
                    "published), or states are at the exposures and the inertial residual contains it."});
  field(
      "time_offset_sigma_s", config.time_offset_sigma_s,
      FieldInfo{"Prior standard deviation of the time offset around the calibrated value.", "s", 1e-6, 1.0});
  field("time_offset_walk", config.time_offset_walk,
        FieldInfo{"Random walk of the time offset in the consistent prior.", "s/sqrt(s)", 0.0, 1.0});
  field("time_offset_bound_s", config.time_offset_bound_s,
        FieldInfo{
            "Largest deviation of the time offset from the calibrated value; samples are awaited up to it.",
            "s", 1e-3, 1.0});
  field("estimate_extrinsics", config.estimate_extrinsics,
        FieldInfo{.text = "Whether the transform between camera and IMU is estimated."});
  field("estimate_lens", config.estimate_lens,
        FieldInfo{.text = "Whether corrections of focal length, radial distortion and principal point are "
                          "estimated; none without an IMU."});
  field("extrinsics_sigma_m", config.extrinsics_sigma_m,
        FieldInfo{"Prior standard deviation of the lever arm around the calibrated value.", "m", 1e-6, 1.0});
  field("extrinsics_sigma_rad", config.extrinsics_sigma_rad,
        FieldInfo{"Prior standard deviation of the rotation between camera and IMU.", "rad", 1e-6, 1.0});
  field("extrinsics_bound_m", config.extrinsics_bound_m,
        FieldInfo{"Largest deviation of the lever arm from the calibrated value.", "m", 1e-3, 10.0});
  field("extrinsics_bound_rad", config.extrinsics_bound_rad,
        FieldInfo{"Largest deviation of the rotation between camera and IMU.", "rad", 1e-3, 3.14});
  field(
      "calibration_agreement_probability", config.calibration_agreement_probability,
      FieldInfo{
          "Estimated extrinsics and depth scale keep the values of the rig until the data contradicts those "
          "with this probability; 0 = they are estimated from the start.",
          "", 0.0, 0.999999});
}

/// Keys of the loss of the pose.
template <class Visitor, class Config>
void visit_loss_fields(Visitor&& field, Config& config) {
  field("max_dead_reckoning_s", config.max_dead_reckoning_s,
        FieldInfo{"After a longer time without vision the pose is lost.", "s", 0.0, 1000.0});
  field("depth", config.depth);
  field("initializer", config.initializer);
}

template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, BackendConfig>
void visit_fields(Visitor&& field, Config& config) {
  visit_window_fields(field, config);
  visit_noise_fields(field, config);
  visit_calibration_fields(field, config);
  visit_loss_fields(field, config);
}

}  // namespace stillpoint
