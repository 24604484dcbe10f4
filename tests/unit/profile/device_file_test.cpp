// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/device_file.h"

#include <gtest/gtest.h>

#include "bench/config/toml_source.h"
#include "bench/systems/published_table.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

TEST(DeviceFile, EmbeddedFilesAreValid) {
  for (const std::string& name : embedded_names(TomlKind::kDevice))
    EXPECT_FALSE(load_device(name).title.empty());
}

/// The row of Table III.
std::map<std::string, double> published(const std::string& system) {
  for (const PublishedRow& row : load_published("runtime_market").rows) {
    if (row.system == system) return row.values;
  }
  return {};
}

TEST(DeviceFile, StageCostsMatchPaperTableIII) {
  const std::pair<const char*, const char*> devices[] = {
      {"jetson_agx_xavier", "Dynamic-VINS on Jetson AGX Xavier"},
      {"atlas_200", "Dynamic-VINS on Atlas200 DK"}};
  for (const auto& [device, system] : devices) {
    std::map<std::string, double> row = published(system);
    const DeviceModel model = device_model(load_device(device));
    EXPECT_TRUE(model.is_deterministic());
    EXPECT_EQ(model.tracking.fixed_ms, row["tracking_thread"]) << device;
    EXPECT_EQ(model.detection.fixed_ms, row["object_detection"]) << device;
    EXPECT_EQ(model.optimization.fixed_ms, row["optimization_thread"]) << device;
  }
}

TEST(DeviceFile, StagesWithoutFixedCostAreScaledByFactor) {
  const TemporaryFolder folder;
  const DeviceModel model = device_model(
      load_device(folder.write("mine.toml", "cores = 4\n[factor]\ntracking_thread = 2.5\n").string()));
  EXPECT_EQ(model.cores, 4);
  EXPECT_FALSE(model.is_deterministic());
  EXPECT_FALSE(model.tracking.fixed_ms);
  EXPECT_EQ(model.tracking.factor, 2.5);
  EXPECT_EQ(model.optimization.factor, 1.0);
}

TEST(DeviceFile, RejectsUnknownNamesKeysAndNegativeFactors) {
  const TemporaryFolder folder;
  expect_input_error([] { static_cast<void>(load_device("jetson_agx_xavie")); },
                     {"device \"jetson_agx_xavie\"", "did you mean \"jetson_agx_xavier\"?"});
  expect_input_error([&] { static_cast<void>(load_device(folder.write("a.toml", "core = 4\n").string())); },
                     {"a.toml:1", "unknown key \"core\"", "\"cores\""});
  expect_input_error(
      [&] {
        static_cast<void>(load_device(folder.write("b.toml", "[factor]\ntracking_thread = -0.5\n").string()));
      },
      {"b.toml", "negative factor"});
}

}  // namespace
}  // namespace stillpoint::bench
