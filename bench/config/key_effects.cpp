// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/key_effects.h"

#include <array>

namespace stillpoint::bench {
namespace {

using Config = const OdometryConfig&;

bool uses_imu(Config config) { return config.imu.enabled; }
bool detects(Config config) { return used_detector(config) != DetectorKind::kNone; }
bool uses_network(Config config) { return used_detector(config) == DetectorKind::kNetwork; }
bool simulates(Config config) { return used_detector(config) == DetectorKind::kSimulated; }
bool compensates(Config config) { return detects(config) && config.dynamic.missed_detection; }
bool checks_consistency(Config config) { return config.dynamic.moving_consistency; }
bool gates(Config config) { return checks_consistency(config) && config.dynamic.gate_before_solve; }
bool has_depth_mask(Config config) {
  return config.dynamic.mask == DynamicMask::kDepthThreshold ||
         config.dynamic.mask == DynamicMask::kDepthBand;
}
bool has_masks(Config config) { return config.frontend.circular_mask; }
bool has_grid(Config config) { return config.frontend.detector == FeatureDetectorKind::kGridFast; }
bool tracks_patches(Config config) { return config.frontend.tracker == TrackerKind::kPatch; }
bool tracks_by_opencv(Config config) { return config.frontend.tracker == TrackerKind::kOpenCv; }
bool is_consistent(Config config) { return config.backend.prior == PriorModel::kConsistent; }
bool estimates_extrinsics(Config config) {
  return config.backend.estimate_extrinsics || config.backend.initializer.align_rotations;
}
bool estimates_time_offset(Config config) { return config.backend.estimate_time_offset; }
bool estimates_scale(Config config) { return config.backend.depth.estimate_scale; }
bool estimates_rig(Config config) {
  return estimates_extrinsics(config) || estimates_scale(config) || config.backend.estimate_lens;
}
bool uses_depth(Config config) { return config.backend.depth.usage != DepthUsage::kOff; }
bool weights_depth(Config config) { return config.backend.depth.usage == DepthUsage::kWeighted; }
bool is_monocular(Config config) { return config.backend.initializer.kind == InitializerKind::kMonocular; }
bool has_covariance(Config config) { return config.backend.covariance; }
bool closes_loops(Config config) { return config.loop.enabled; }

constexpr std::string_view kImu = "imu.enabled = true";
constexpr std::string_view kDetector = "a detector: detector.kind and dynamic.mask other than none and off";
constexpr std::string_view kNetwork = "detector.kind = network";
constexpr std::string_view kConsistency = "dynamic.moving_consistency = true";
constexpr std::string_view kConsistentPrior = "backend.prior = consistent";
constexpr std::string_view kExtrinsics = "backend.estimate_extrinsics or backend.initializer.align_rotations";
constexpr std::string_view kTimeOffset = "backend.estimate_time_offset = true";
constexpr std::string_view kScale = "backend.depth.estimate_scale = true";
constexpr std::string_view kDepth = "backend.depth.usage other than off";
constexpr std::string_view kLoops = "loop.enabled = true";

constexpr std::array kConditions = {
    KeyCondition{"imu.gravity", kImu, uses_imu},
    KeyCondition{"imu.noise_scale", kImu, uses_imu},
    KeyCondition{"imu.adapt_noise", kImu, uses_imu},
    KeyCondition{"imu.gyro_", kImu, uses_imu},
    KeyCondition{"imu.accel_", kImu, uses_imu},
    KeyCondition{"frontend.min_distance_px", "frontend.circular_mask = true", has_masks},
    KeyCondition{"frontend.unstable_radius_px", "frontend.circular_mask = true", has_masks},
    KeyCondition{"frontend.grid.", "frontend.detector = grid_fast", has_grid},
    KeyCondition{"frontend.window_px", "frontend.tracker = opencv", tracks_by_opencv},
    KeyCondition{"frontend.min_correlation", "frontend.tracker = patch", tracks_patches},
    KeyCondition{"detector.every_n_frames", kDetector, detects},
    KeyCondition{"detector.weights", kNetwork, uses_network},
    KeyCondition{"detector.cfg", kNetwork, uses_network},
    KeyCondition{"detector.names", kNetwork, uses_network},
    KeyCondition{"detector.layout", kNetwork, uses_network},
    KeyCondition{"detector.backend", kNetwork, uses_network},
    KeyCondition{"detector.input_px", kNetwork, uses_network},
    KeyCondition{"detector.score_threshold", kNetwork, uses_network},
    KeyCondition{"detector.nms_threshold", kNetwork, uses_network},
    KeyCondition{"detector.simulated.", "detector.kind = simulated", simulates},
    KeyCondition{"dynamic.epsilon_m", "dynamic.mask = depth_threshold or depth_band", has_depth_mask},
    KeyCondition{"dynamic.epsilon_m", kDetector, detects},
    KeyCondition{"dynamic.depth_window_px", kDetector, detects},
    KeyCondition{"dynamic.box_margin_px", kDetector, detects},
    KeyCondition{"dynamic.classes", kDetector, detects},
    KeyCondition{"dynamic.unmeasured_is_dynamic", kDetector, detects},
    KeyCondition{"dynamic.missed_detection", kDetector, detects},
    KeyCondition{"dynamic.max_missed_frames", "dynamic.missed_detection = true and a detector", compensates},
    KeyCondition{"dynamic.max_skipped_frames", "dynamic.missed_detection = true and a detector", compensates},
    KeyCondition{"dynamic.growth_px_per_miss", "dynamic.missed_detection = true and a detector", compensates},
    KeyCondition{"dynamic.mcc_", kConsistency, checks_consistency},
    KeyCondition{"dynamic.recycle_min_frames", kConsistency, checks_consistency},
    KeyCondition{"dynamic.min_static_frames", kConsistency, checks_consistency},
    KeyCondition{"dynamic.gate_", kConsistency, checks_consistency},
    KeyCondition{"dynamic.gate_probability", "dynamic.gate_before_solve = true", gates},
    KeyCondition{"dynamic.gate_probability", "backend.covariance = true", has_covariance},
    KeyCondition{"backend.gravity", kImu, uses_imu},
    KeyCondition{"backend.prior", kImu, uses_imu},
    KeyCondition{"backend.bias_steps", kImu, uses_imu},
    KeyCondition{"backend.max_dead_reckoning_s", kImu, uses_imu},
    KeyCondition{"backend.estimate_", kImu, uses_imu},
    KeyCondition{"backend.time_offset_", kImu, uses_imu},
    KeyCondition{"backend.time_offset_sigma_s", kTimeOffset, estimates_time_offset},
    KeyCondition{"backend.time_offset_walk", kTimeOffset, estimates_time_offset},
    KeyCondition{"backend.time_offset_walk", kConsistentPrior, is_consistent},
    KeyCondition{"backend.extrinsics_", kImu, uses_imu},
    KeyCondition{"backend.extrinsics_", kExtrinsics, estimates_extrinsics},
    KeyCondition{"backend.calibration_agreement_probability",
                 "an estimate of extrinsics, depth scale or lens", estimates_rig},
    KeyCondition{"backend.depth.max_m", kDepth, uses_depth},
    KeyCondition{"backend.depth.inverse_sigma", kDepth, uses_depth},
    KeyCondition{"backend.depth.agreement_probability", kDepth, uses_depth},
    KeyCondition{"backend.depth.max_scale_error", kDepth, uses_depth},
    KeyCondition{"backend.depth.outlier_sigmas", "backend.depth.usage = weighted", weights_depth},
    KeyCondition{"backend.depth.estimate_scale", kImu, uses_imu},
    KeyCondition{"backend.depth.scale_", kScale, estimates_scale},
    KeyCondition{"backend.initializer.", kImu, uses_imu},
    KeyCondition{"backend.initializer.max_scale_sigma", "backend.initializer.kind = monocular", is_monocular},
    KeyCondition{"loop.dof", kLoops, closes_loops},
    KeyCondition{"loop.lag_frames", kLoops, closes_loops},
    KeyCondition{"loop.min_", kLoops, closes_loops},
    KeyCondition{"loop.exclude_dynamic", kLoops, closes_loops},
    KeyCondition{"loop.final_bundle_adjustment", kLoops, closes_loops},
};

}  // namespace

std::span<const KeyCondition> key_conditions() { return kConditions; }

std::string_view missing_requirement(std::string_view key, const OdometryConfig& config) {
  for (const KeyCondition& condition : kConditions) {
    if (key.starts_with(condition.prefix) && !condition.holds(config)) return condition.requirement;
  }
  return {};
}

}  // namespace stillpoint::bench
