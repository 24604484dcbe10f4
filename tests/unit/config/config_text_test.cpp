// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/config_file.h"

#include <cmath>

#include <gtest/gtest.h>

#include "bench/config/config_hash.h"
#include "bench/config/config_keys.h"
#include "bench/config/settings.h"
#include "bench/model/stored_run.h"

namespace stillpoint::bench {
namespace {

TEST(ConfigText, ReadsBackToTheSameConfig) {
  OdometryConfig config;
  config.imu.gravity = 9.8000000000000007;  // requires 17 digits
  config.frontend.prediction = TrackerPrediction::kRotation;
  config.backend.rate_hz = 15.0;
  const OdometryConfig read = with_settings(OdometryConfig{}, parse_settings(config_text(config), "text"));
  EXPECT_EQ(config_entries(read), config_entries(config));
}

TEST(ConfigText, HashChangesWithOneValue) {
  OdometryConfig changed;
  changed.seed = 2;
  EXPECT_NE(config_hash(changed), config_hash(OdometryConfig{}));
  EXPECT_EQ(config_hash(OdometryConfig{}), config_hash(OdometryConfig{}));
}

TEST(ConfigText, HashOfReplicatesDiffersInTheSeedOnly) {
  OdometryConfig replicate;
  replicate.pipeline.perturbation_seed = 3;
  const std::string hash = config_hash(replicate);
  EXPECT_EQ(hash, config_hash(OdometryConfig{}) + "-perturbed-3");
  EXPECT_EQ(unperturbed_hash(hash), config_hash(OdometryConfig{}));
  EXPECT_TRUE(is_perturbed(hash));
  EXPECT_FALSE(is_perturbed(config_hash(OdometryConfig{})));
}

TEST(ConfigText, DifferenceNamesTheChangedKeysOnly) {
  OdometryConfig changed;
  changed.frontend.grid.rows = 5;
  const std::vector<ConfigEntry> expected = {{"frontend.grid.rows", "5"}};
  EXPECT_EQ(config_difference(OdometryConfig{}, changed), expected);
}

TEST(ConfigText, ReferenceShowsMeaningTypeRangeDefaultAndPaper) {
  const std::string page = config_reference();
  EXPECT_NE(
      page.find(
          "| `frontend.grid.rows` | Rows of the grid. | integer | 1 to 64 | `7` | III-B; value: IV-C |"),
      std::string::npos);
  EXPECT_NE(page.find(" | \"grid_fast\", \"shi_tomasi\" |  | `\"grid_fast\"` | III-B |"), std::string::npos);
  EXPECT_NE(page.find(" | number | 9 to 10 m/s^2 | `9.81` |  |"), std::string::npos);
}

TEST(ConfigText, EveryKeyHasASentenceAndEveryNumberARangeThatContainsItsDefault) {
  OdometryConfig defaults;
  for (const ConfigField& field : fields_of(defaults)) {
    EXPECT_TRUE(field.info.text.ends_with('.')) << field.key;
    EXPECT_GE(field.info.text.size(), 15u) << field.key;
    double value = 0.0;
    if (const auto* number = std::get_if<double*>(&field.member)) {
      value = **number;
    } else if (const auto* integer = std::get_if<int*>(&field.member)) {
      value = **integer;
    } else {
      continue;
    }
    EXPECT_TRUE(std::isfinite(field.info.min) && std::isfinite(field.info.max)) << field.key;
    EXPECT_TRUE(field.info.min <= value && value <= field.info.max) << field.key;
  }
}

TEST(ConfigText, KeysWithAUnitInTheirNameHaveThisUnit) {
  const std::vector<std::pair<std::string, std::string>> units = {
      {"_px", "px"}, {"_s", "s"}, {"_m", "m"}, {"_rad", "rad"}, {"_hz", "Hz"}, {"_frames", "frames"}};
  OdometryConfig defaults;
  for (const ConfigField& field : fields_of(defaults)) {
    for (const auto& [suffix, unit] : units) {
      if (!field.key.ends_with(suffix)) continue;
      EXPECT_EQ(field.info.unit, unit) << field.key;
    }
  }
}

TEST(ConfigText, ThereAreAtMost120Keys) {
  OdometryConfig defaults;
  EXPECT_LE(fields_of(defaults).size(), 120u);
}

TEST(ConfigText, DifferenceShowsBothValuesAndTheUnit) {
  OdometryConfig changed;
  changed.backend.window_size = 12;
  changed.backend.cauchy_scale = 0.5;
  changed.imu.enabled = false;
  EXPECT_EQ(difference_text(different_keys(OdometryConfig{}, changed)),
            "imu.enabled = true -> false\n"
            "backend.window_size = 10 -> 12 frames\n"
            "backend.cauchy_scale = 1.0 -> 0.5 sigma\n");
  EXPECT_EQ(difference_text(different_keys(changed, changed)), "");
}

}  // namespace
}  // namespace stillpoint::bench
