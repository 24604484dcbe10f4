// SPDX-License-Identifier: BSD-3-Clause
#include "bench/config/config_file.h"

#include <gtest/gtest.h>

#include "bench/config/settings.h"
#include "bench/model/stored_run.h"

namespace stillpoint::bench {
namespace {

TEST(ConfigText, ReadsBackToTheSameConfig) {
  OdometryConfig config;
  config.imu.gravity = 9.8000000000000007;  // requires 17 digits
  config.frontend.prediction = TrackerPrediction::kFull;
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

TEST(ConfigText, ReferenceShowsTypeRangeAndDefault) {
  const std::string page = config_reference();
  EXPECT_NE(page.find("| `frontend.grid.rows` | integer | 1 to 64 | `7` |"), std::string::npos);
  EXPECT_NE(page.find("| `frontend.detector` | \"grid_fast\", \"shi_tomasi\" |  | `\"grid_fast\"` |"),
            std::string::npos);
}

}  // namespace
}  // namespace stillpoint::bench
