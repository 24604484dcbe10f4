// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/key_effects.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "bench/config/config_file.h"
#include "bench/config/settings.h"
#include "bench/config/toml_source.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

using Messages = std::vector<std::string>;

Messages warnings_of(const std::string& variant, const std::vector<std::string>& settings) {
  return settings_without_effect({.base = "stillpoint", .variant = variant, .settings = settings});
}

TEST(KeyEffects, EachPrefixNamesAKey) {
  OdometryConfig defaults;
  const std::vector<ConfigField> fields = fields_of(defaults);
  for (const KeyCondition& condition : key_conditions()) {
    EXPECT_TRUE(std::ranges::any_of(fields, [&](const ConfigField& field) {
      return field.key.starts_with(condition.prefix);
    })) << condition.prefix;
  }
}

TEST(KeyEffects, NamesWhatASettingOfTheUserRequires) {
  EXPECT_EQ(warnings_of("dynamic_vins", {"backend.extrinsics_sigma_m=0.05"}),
            Messages{"--set: \"backend.extrinsics_sigma_m\" has no effect; it requires "
                     "backend.estimate_extrinsics or backend.initializer.align_rotations"});
  EXPECT_EQ(warnings_of("vo", {"imu.gyro_noise=0.001"}),
            Messages{"--set: \"imu.gyro_noise\" has no effect; it requires imu.enabled = true"});
  const TemporaryFolder folder;
  const std::string file = folder.write("mine.toml", "seed = 2\n[loop]\nmin_gap_s = 3.0").string();
  EXPECT_EQ(warnings_of(file, {}),
            Messages{file + ":3: \"loop.min_gap_s\" has no effect; it requires loop.enabled = true"});
}

TEST(KeyEffects, ASettingWhoseRequirementIsMetGivesNoMessage) {
  EXPECT_EQ(warnings_of("", {"backend.extrinsics_sigma_m=0.05", "backend.estimate_extrinsics=true"}),
            Messages{});
  EXPECT_EQ(warnings_of("loop_closure", {"loop.min_gap_s=3"}), Messages{});
  EXPECT_EQ(warnings_of("", {"detector.kind=simulated", "detector.simulated.miss_rate=0.5"}), Messages{});
}

TEST(KeyEffects, AFileMayStateAllKeysOfAShippedConfig) {
  const TemporaryFolder folder;
  const OdometryConfig stillpoint = load_config({});
  const std::string file = folder.write("all.toml", config_text(stillpoint)).string();
  EXPECT_EQ(warnings_of(file, {}), Messages{});
}

TEST(KeyEffects, ShippedConfigsGiveNoMessage) {
  for (const std::string& name : embedded_names(TomlKind::kConfig))
    EXPECT_EQ(warnings_of(name, {}), Messages{});
}

/// Values that are not the shipped ones, with and without what they require.
TEST(KeyEffects, EachConditionIsMetByItsRequirement) {
  OdometryConfig all = load_config({});
  all.loop.enabled = true;
  all.backend.estimate_extrinsics = true;
  all.backend.depth.estimate_scale = true;
  const Messages excluded = {"frontend.window_px", "detector.", "backend.initializer.max_scale_sigma"};
  OdometryConfig copy = all;
  for (const ConfigField& field : fields_of(copy)) {
    const bool is_excluded =
        std::ranges::any_of(excluded, [&](const std::string& key) { return field.key.starts_with(key); });
    if (is_excluded) continue;
    EXPECT_EQ(missing_requirement(field.key, all), "") << field.key;
  }
}

}  // namespace
}  // namespace stillpoint::bench
