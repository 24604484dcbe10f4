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

enum class InitializerKind { kWindow, kInstant };
constexpr auto enum_names(InitializerKind) {
  return EnumNames<InitializerKind, 2>{
      {{InitializerKind::kWindow, "window"}, {InitializerKind::kInstant, "instant"}}};
}

/// How measured depth enters the estimate.
struct DepthConfig {
  DepthUsage usage = DepthUsage::kFixed;
  double min_m = 0.3;            ///< nearer measurements are not believed
  double max_m = 8.0;            ///< farther ones neither
  double inverse_sigma = 0.003;  ///< standard deviation of 1/depth [1/m]: sigma_Z = this * Z^2
  double agreement_px = 10.0;    ///< reprojection within which two views' depths agree
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, DepthConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("usage", config.usage);
  field("min_m", config.min_m, 0.01, 10.0);
  field("max_m", config.max_m, 0.1, 100.0);
  field("inverse_sigma", config.inverse_sigma, 1e-5, 1.0);
  field("agreement_px", config.agreement_px, 0.1, 100.0);
}

struct InitializerConfig {
  InitializerKind kind = InitializerKind::kWindow;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, InitializerConfig>
void visit_fields(Visitor&& field, Config& config) { field("kind", config.kind); }

struct BackendConfig {
  double rate_hz = 10.0;               ///< pictures a second that enter the window; 0 = every one
  int window_size = 10;                ///< states before the newest
  double keyframe_parallax_px = 10.0;  ///< mean displacement that makes a keyframe
  int keyframe_min_tracked = 20;       ///< fewer known features make a keyframe
  double pixel_sigma_px = 1.5;         ///< standard deviation of a feature's position
  double cauchy_scale = 1.0;           ///< of the robust loss, in standard deviations
  int max_iterations = 8;
  bool estimate_time_offset = true;
  bool estimate_extrinsics = false;
  DepthConfig depth;
  InitializerConfig initializer;
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, BackendConfig>
void visit_fields(Visitor&& field, Config& config) {
  field("rate_hz", config.rate_hz, 0.0, 1000.0);
  field("window_size", config.window_size, 4, 40);
  field("keyframe_parallax_px", config.keyframe_parallax_px, 0.1, 200.0);
  field("keyframe_min_tracked", config.keyframe_min_tracked, 0, 1000);
  field("pixel_sigma_px", config.pixel_sigma_px, 0.05, 20.0);
  field("cauchy_scale", config.cauchy_scale, 0.01, 100.0);
  field("max_iterations", config.max_iterations, 1, 100);
  field("estimate_time_offset", config.estimate_time_offset);
  field("estimate_extrinsics", config.estimate_extrinsics);
  field("depth", config.depth);
  field("initializer", config.initializer);
}

}  // namespace stillpoint
