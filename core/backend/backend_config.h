// SPDX-License-Identifier: BSD-3-Clause
/// Settings of the estimator: window, solver, depth, initialisation. Defaults are Dynamic-VINS'.
#pragma once

#include <type_traits>

#include "core/base/fields.h"

namespace stillpoint {

enum class DepthUsage { kOff, kFixed, kWeighted };
constexpr auto enum_names(DepthUsage) {
  return EnumNames<DepthUsage, 3>{
      {{DepthUsage::kOff, "off"}, {DepthUsage::kFixed, "fixed"}, {DepthUsage::kWeighted, "weighted"}}};
}

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

/// How measured depth enters the estimate.
struct DepthConfig {
  DepthUsage usage = DepthUsage::kFixed;
  double min_m = 0.3;            ///< nearer measurements are not believed
  double max_m = 8.0;            ///< farther ones neither
  double inverse_sigma = 0.003;  ///< standard deviation of 1/depth [1/m]: sigma_Z = this * Z^2
  double outlier_sigmas = 2.0;   ///< a weighted depth saturates here
  double agreement_px = 10.0;    ///< reprojection within which two views' depths agree
  double farthest_m = 100.0;     ///< no landmark is put beyond
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
  field("farthest_m", config.farthest_m, 10.0, 10000.0);
}

/// Uncertainty of the first state; what it is sure of (position, heading) is the gauge.
struct InitializerConfig {
  InitializerKind kind = InitializerKind::kWindow;
  double min_span_s = 0.3;         ///< instant: shortest time in which gravity is looked for
  double gyro_bias_sigma = 0.02;   ///< [rad/s]
  double accel_bias_sigma = 0.1;   ///< [m/s^2]
  double gravity_tolerance = 1.0;  ///< a gravity that is off by more is refused [m/s^2]
  int min_common_features = 30;   ///< monocular: seen by the two frames that start. Qin et al. 2018, Sec. V-A
  double min_parallax_px = 20.0;  ///< monocular: between them, without rotation; same source
  double max_scale_sigma =
      0.1;  ///< monocular: relative standard deviation of a scale that is still taken; own choice
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, InitializerConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("kind", config.kind);
  field("min_span_s", config.min_span_s, 0.1, 10.0);
  field("gyro_bias_sigma", config.gyro_bias_sigma, 1e-5, 10.0);
  field("accel_bias_sigma", config.accel_bias_sigma, 1e-5, 10.0);
  field("gravity_tolerance", config.gravity_tolerance, 0.01, 9.0);
  field("min_common_features", config.min_common_features, 10, 1000);
  field("min_parallax_px", config.min_parallax_px, 1.0, 200.0);
  field("max_scale_sigma", config.max_scale_sigma, 1e-3, 10.0);
}

/// The longest window that may be configured.
inline constexpr int kMaxWindowSize = 40;

struct BackendConfig {
  double rate_hz = 10.0;               ///< pictures a second that enter the window; 0 = every one
  int window_size = 10;                ///< states before the newest
  double keyframe_parallax_px = 10.0;  ///< mean displacement that makes a keyframe
  int keyframe_min_tracked = 20;       ///< fewer still features shared with the last keyframe make another
  double keyframe_min_shared = 0.5;    ///< the same as a share of the still features; 0 = never, as in the
                                       ///< published code, where people's features make parallax
  double pixel_sigma_px = 1.5;         ///< standard deviation of a feature's position
  double pixel_misfit_px = 0.0;  ///< median misfit that belongs to pixel_sigma_px: more widens it; 0 = never
  double cauchy_scale = 1.0;     ///< of the robust loss, in standard deviations
  WindowSolverKind solver = WindowSolverKind::kCeres;  ///< who minimises and marginalises; same residuals
  int max_iterations = 8;
  double function_tolerance = 1e-6;      ///< relative change of the cost that ends the solve
  double keyframe_max_interval_s = 5.0;  ///< a keyframe at least this often: inertial spans must stay short
  bool estimate_time_offset = true;
  double time_offset_sigma_s = 0.01;  ///< how far the rig's value may be off
  bool estimate_extrinsics = false;
  double extrinsics_sigma_m = 0.02;
  double extrinsics_sigma_rad = 0.02;
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
  field("keyframe_min_shared", config.keyframe_min_shared, 0.0, 1.0);
  field("pixel_sigma_px", config.pixel_sigma_px, 0.05, 20.0);
  field("pixel_misfit_px", config.pixel_misfit_px, 0.0, 20.0);
  field("cauchy_scale", config.cauchy_scale, 0.01, 100.0);
  field("solver", config.solver);
  field("max_iterations", config.max_iterations, 1, 100);
  field("function_tolerance", config.function_tolerance, 1e-12, 0.1);
  field("keyframe_max_interval_s", config.keyframe_max_interval_s, 0.05, 10.0);
  field("estimate_time_offset", config.estimate_time_offset);
  field("time_offset_sigma_s", config.time_offset_sigma_s, 1e-6, 1.0);
  field("estimate_extrinsics", config.estimate_extrinsics);
  field("extrinsics_sigma_m", config.extrinsics_sigma_m, 1e-6, 1.0);
  field("extrinsics_sigma_rad", config.extrinsics_sigma_rad, 1e-6, 1.0);
  field("depth", config.depth);
  field("initializer", config.initializer);
}

}  // namespace stillpoint
