// SPDX-License-Identifier: BSD-3-Clause
// The exact keys in which each shipped config differs from its parent.
#include <algorithm>

#include <gtest/gtest.h>

#include "bench/config/config_file.h"
#include "bench/config/config_keys.h"
#include "bench/config/settings.h"
#include "bench/config/toml_source.h"

namespace stillpoint::bench {
namespace {

using Entries = std::vector<ConfigEntry>;

OdometryConfig base(const std::string& name) {
  return load_config({.base = name, .variant = "", .settings = {}});
}

/// The keys that an overlay changes on top of a base.
Entries changes(const std::string& base_name, const std::string& overlay) {
  return config_difference(base(base_name),
                           load_config({.base = base_name, .variant = overlay, .settings = {}}));
}

TEST(ConfigOverlays, WithoutCircularMaskDisablesBothCircles) {
  EXPECT_EQ(changes("stillpoint", "wo_circular_mask"), (Entries{{"frontend.circular_mask", "false"}}));
}

TEST(ConfigOverlays, WithoutImuPredictionDisablesPrediction) {
  EXPECT_EQ(changes("stillpoint", "wo_imu_prediction"), (Entries{{"frontend.prediction", "\"none\""}}));
  EXPECT_EQ(changes("dynamic_vins", "wo_imu_prediction"), (Entries{{"frontend.prediction", "\"none\""}}));
}

TEST(ConfigOverlays, WithoutDriftCorrectionTracksFromFrameToFrame) {
  EXPECT_EQ(changes("stillpoint", "wo_drift_correction"),
            (Entries{{"frontend.drift_min_correlation", "0.0"}}));
  EXPECT_EQ(changes("dynamic_vins", "wo_drift_correction"), Entries{});
}

TEST(ConfigOverlays, WithoutGridDetectionUsesShiTomasi) {
  EXPECT_EQ(changes("stillpoint", "wo_grid_detection"), (Entries{{"frontend.detector", "\"shi_tomasi\""}}));
}

TEST(ConfigOverlays, WithoutDepthWeightFixesMeasuredDepthAsDynamicVinsDoes) {
  EXPECT_EQ(changes("stillpoint", "wo_depth_weight"), (Entries{{"backend.depth.usage", "\"fixed\""}}));
  EXPECT_EQ(changes("dynamic_vins", "wo_depth_weight"), Entries{});
}

/// Expects that an overlay changes the same single key of both systems.
void expect_one_change(const std::string& overlay, const ConfigEntry& change) {
  EXPECT_EQ(changes("stillpoint", overlay), Entries{change});
  EXPECT_EQ(changes("dynamic_vins", overlay), Entries{change});
}

TEST(ConfigOverlays, AblationsOfDynamicFeatureRecognitionChangeOneKeyEach) {
  expect_one_change("wo_object_detection", {"detector.kind", "\"none\""});
  expect_one_change("wo_seg_like_mask", {"dynamic.mask", "\"whole_box\""});
  expect_one_change("wo_mcc", {"dynamic.moving_consistency", "false"});
  expect_one_change("wo_missed_detection", {"dynamic.missed_detection", "false"});
}

TEST(ConfigOverlays, DepthBandSetsTheMaskOfStillpoint) {
  EXPECT_EQ(changes("dynamic_vins", "depth_band"),
            (Entries{{"dynamic.mask", "\"depth_band\""}, {"dynamic.epsilon_m", "0.4"}}));
  EXPECT_EQ(changes("stillpoint", "depth_band"), Entries{});
}

TEST(ConfigOverlays, PublishedPriorTakesThePriorOfDynamicVins) {
  EXPECT_EQ(changes("stillpoint", "published_prior"), (Entries{{"backend.pixel_sigma_px", "1.5"},
                                                               {"backend.prior", "\"published\""},
                                                               {"backend.time_offset_model", "\"bearing\""},
                                                               {"backend.time_offset_walk", "0.0"}}));
  EXPECT_EQ(changes("dynamic_vins", "published_prior"), Entries{});
}

TEST(ConfigOverlays, BearingTimeOffsetIsThatOfDynamicVins) {
  EXPECT_EQ(changes("stillpoint", "bearing_time_offset"),
            (Entries{{"backend.time_offset_model", "\"bearing\""}}));
  EXPECT_EQ(changes("dynamic_vins", "bearing_time_offset"), Entries{});
}

TEST(ConfigOverlays, VoDisablesTheImuAndRequiresMoreSharedFeatures) {
  EXPECT_EQ(changes("stillpoint", "vo"), (Entries{{"imu.enabled", "false"},
                                                  {"frontend.outlier_model", "\"majority\""},
                                                  {"backend.keyframe_min_shared_ratio", "0.7"},
                                                  {"backend.pixel_sigma_px", "0.5"},
                                                  {"backend.pixel_noise_scale", "2.0"},
                                                  {"backend.cauchy_scale", "0.5"}}));
}

TEST(ConfigOverlays, DynamicVinsVoHasThePublishedTumSettings) {
  EXPECT_EQ(config_difference(base("dynamic_vins"), base("dynamic_vins_vo")),
            (Entries{{"imu.enabled", "false"},
                     {"frontend.max_features", "250"},
                     {"frontend.min_distance_px", "10"},
                     {"frontend.unstable_radius_px", "10"},
                     {"backend.rate_hz", "0.0"},
                     {"backend.depth.min_m", "0.4"},
                     {"backend.depth.max_m", "10.0"}}));
}

/// A key with its published value and the default.
struct ChangedKey {
  std::string key, published, stillpoint;
  friend bool operator==(const ChangedKey&, const ChangedKey&) = default;
};
const std::vector<ChangedKey> kKeysOfStillpoint = {
    {"imu.adapt_noise", "false", "true"},
    {"frontend.min_distance_px", "30", "20"},
    {"frontend.unstable_radius_px", "30", "20"},
    {"frontend.prediction", "\"rotation\"", "\"full\""},
    {"frontend.tracker", "\"opencv\"", "\"patch\""},
    {"frontend.window_px", "21", "15"},
    {"frontend.min_correlation", "0.8", "0.6"},
    {"frontend.outlier_model", "\"epipolar\"", "\"rigid\""},
    {"frontend.ransac_threshold_px", "1.0", "2.0"},
    {"frontend.ransac_min_inlier_ratio", "0.0", "0.5"},
    {"frontend.reject_static_only", "false", "true"},
    {"frontend.drift_min_correlation", "0.0", "0.9"},
    {"frontend.recover_view", "false", "true"},
    {"frontend.depth_max_spread", "0.0", "0.05"},
    {"frontend.grid.stop_early", "false", "true"},
    {"dynamic.mask", "\"depth_threshold\"", "\"depth_band\""},
    {"dynamic.epsilon_m", "1.0", "0.4"},
    {"dynamic.depth_window_px", "1", "5"},
    {"dynamic.box_margin_px", "10.0", "2.0"},
    {"dynamic.unmeasured_is_dynamic", "true", "false"},
    {"dynamic.max_skipped_frames", "3", "10"},
    {"dynamic.growth_px_per_miss", "10.0", "3.0"},
    {"dynamic.mcc_threshold_px", "10.0", "5.0"},
    {"dynamic.mcc_min_observations", "2", "3"},
    {"dynamic.recycle_min_frames", "0", "3"},
    {"dynamic.min_static_frames", "0", "3"},
    {"dynamic.masked_static_frames", "0", "30"},
    {"dynamic.gate_before_solve", "false", "true"},
    {"dynamic.gate_probability", "0.0", "0.99999"},
    {"dynamic.min_stable_features", "0", "20"},
    {"backend.rate_hz", "10.0", "0.0"},
    {"backend.keyframe_min_shared_ratio", "0.0", "0.5"},
    {"backend.keyframe_max_interval_s", "10.0", "0.5"},
    {"backend.pixel_sigma_px", "1.5", "0.25"},
    {"backend.pixel_noise_scale", "0.0", "1.0"},
    {"backend.max_iterations", "8", "4"},
    {"backend.gravity", "\"fixed\"", "\"estimated\""},
    {"backend.prior", "\"published\"", "\"consistent\""},
    {"backend.covariance", "false", "true"},
    {"backend.bias_steps", "false", "true"},
    {"backend.time_offset_model", "\"bearing\"", "\"inertial\""},
    {"backend.time_offset_sigma_s", "1.0", "0.01"},
    {"backend.time_offset_walk", "0.0", "0.001"},
    {"backend.time_offset_bound_s", "1.0", "0.15"},
    {"backend.estimate_lens", "false", "true"},
    {"backend.extrinsics_bound_m", "10.0", "0.1"},
    {"backend.extrinsics_bound_rad", "3.14", "0.2"},
    {"backend.calibration_agreement_probability", "0.0", "0.9999"},
    {"backend.depth.usage", "\"fixed\"", "\"weighted\""},
    {"backend.depth.max_m", "3.0", "8.0"},
    {"backend.depth.outlier_sigmas", "2.0", "5.0"},
    {"backend.depth.agreement_probability", "0.0", "0.99999"},
    {"backend.depth.max_scale_error", "0.0", "0.04"},
    {"backend.depth.max_landmark_depth_m", "10000.0", "100.0"},
    {"backend.depth.estimate_scale", "false", "true"},
    {"backend.initializer.kind", "\"window\"", "\"instant\""},
    {"backend.initializer.gyro_bias_sigma", "10.0", "0.02"},
    {"backend.initializer.accel_bias_sigma", "10.0", "0.1"},
    {"backend.initializer.align_rotations", "false", "true"},
    {"loop.min_inliers", "30", "50"}};

TEST(ConfigOverlays, StillpointDiffersFromDynamicVinsInTheseKeys) {
  std::vector<ChangedKey> changed;
  for (const DifferentKey& key : different_keys(base("dynamic_vins"), base("stillpoint")))
    changed.push_back({key.key, key.a, key.b});
  EXPECT_EQ(changed, kKeysOfStillpoint);
}

TEST(ConfigOverlays, StillpointIsTheDefaultConstructedConfig) {
  EXPECT_EQ(config_difference(OdometryConfig{}, base("stillpoint")), Entries{});
}

/// Else a change of a default would change the published system, too.
TEST(ConfigOverlays, DynamicVinsStatesEveryKeyOfItsMethods) {
  const TomlSource source = find_toml("dynamic_vins", TomlKind::kConfig);
  const std::vector<Setting> stated = parse_settings(source.text, source.path);
  OdometryConfig config;
  for (const ConfigField& field : fields_of(config)) {
    const std::string group = field.key.substr(0, field.key.find('.'));
    if (group != "frontend" && group != "dynamic" && group != "backend") continue;
    if (field.key == "frontend.grid.threads") continue;  // does not change results
    EXPECT_NE(std::ranges::find(stated, field.key, &Setting::key), stated.end()) << field.key;
  }
}

TEST(ConfigOverlays, LibrariesSelectsOpenCvTrackerAndCeresSolver) {
  EXPECT_EQ(changes("stillpoint", "libraries"),
            (Entries{{"frontend.tracker", "\"opencv\""}, {"backend.solver", "\"ceres\""}}));
  EXPECT_EQ(changes("dynamic_vins", "libraries"), (Entries{{"backend.solver", "\"ceres\""}}));
}

TEST(ConfigOverlays, VinsRgbdIsDynamicVinsWithoutItsContributions) {
  EXPECT_EQ(config_difference(base("dynamic_vins"), base("baselines/vins_rgbd")),
            (Entries{{"frontend.unstable_radius_px", "0"},
                     {"frontend.detector", "\"shi_tomasi\""},
                     {"frontend.prediction", "\"none\""},
                     {"detector.kind", "\"none\""},
                     {"dynamic.mask", "\"off\""},
                     {"dynamic.missed_detection", "false"},
                     {"dynamic.moving_consistency", "false"},
                     {"backend.depth.min_m", "0.1"}}));
}

TEST(ConfigOverlays, VinsMonoIsVinsRgbdWithoutDepth) {
  EXPECT_EQ(config_difference(base("baselines/vins_rgbd"), base("baselines/vins_mono")),
            (Entries{{"backend.depth.usage", "\"off\""},
                     {"backend.initializer.kind", "\"monocular\""},
                     {"backend.initializer.max_scale_sigma", "10.0"}}));
}

TEST(ConfigOverlays, SensorsStateTheirNoiseDensities) {
  EXPECT_EQ(changes("stillpoint", "sensors/datasheet"), (Entries{{"imu.noise_scale", "2.0"}}));
  EXPECT_EQ(changes("stillpoint", "sensors/tum_vi"), (Entries{{"imu.gyro_noise", "0.00048"},
                                                              {"imu.accel_noise", "0.0084"},
                                                              {"imu.gyro_walk", "2.2e-05"},
                                                              {"imu.accel_walk", "0.00086"}}));
}

TEST(ConfigOverlays, EveryEmbeddedConfigLoads) {
  const std::vector<std::string> names = embedded_names(TomlKind::kConfig);
  EXPECT_GE(names.size(), 7u);
  for (const std::string& name : names)
    EXPECT_NO_THROW(static_cast<void>(changes("stillpoint", name))) << name;
}

}  // namespace
}  // namespace stillpoint::bench
