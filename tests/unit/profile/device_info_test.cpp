// SPDX-License-Identifier: BSD-3-Clause
// Reading made-up files of Jetson devices and a laptop; values that are wrong are no values.
#include "bench/profile/meters/device_info.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/profile/meters/run_monitor.h"
#include "tests/support/sysfs_trees.h"

namespace stillpoint::bench {
namespace {

std::optional<EnergyUse> energy_of_one_second(const TemporaryFolder& root) {
  EnergyMeter meter(root.path(), {}, {});
  return meter.use(EnergyMeter::Time{} + std::chrono::seconds(1));
}

TEST(DeviceInfo, ReadsJetPack4) {
  const TemporaryFolder root;
  write_jetpack4(root);
  const DeviceInfo device = device_info(root.path());
  EXPECT_EQ(device.model, "Jetson-AGX");
  EXPECT_EQ(device.cores_online, "0-3");
  EXPECT_EQ(device.governor, "schedutil");
  EXPECT_EQ(device.nvpmodel, "MODE_15W (2)");
  EXPECT_EQ(device.jetpack, "JetPack 4 (L4T R32.7.1)");
  ASSERT_EQ(device.thermal_zones.size(), 2u);
  EXPECT_DOUBLE_EQ(device.thermal_zones[0].celsius.value(), 41.5);
  EXPECT_FALSE(device.thermal_zones[1].celsius);
  EXPECT_DOUBLE_EQ(hottest_celsius(root.path()).value(), 41.5);
  EXPECT_DOUBLE_EQ(energy_of_one_second(root).value().joules, 1.863);  // 1242 + 621 mW
}

TEST(DeviceInfo, ReadsJetPack5And6) {
  for (const char* release : {"# R35 (release), REVISION: 4.1,", "# R36 (release), REVISION: 3.0,"}) {
    const TemporaryFolder root;
    write_jetpack5(root, release);
    const DeviceInfo device = device_info(root.path());
    EXPECT_EQ(device.jetpack,
              release[3] == '3' && release[4] == '5' ? "JetPack 5 (L4T R35.4.1)" : "JetPack 6 (L4T R36.3.0)");
    EXPECT_EQ(device.nvpmodel, "MAXN (0)");
    EXPECT_EQ(device.power_rails.size(), 2u);  // without the unconnected channel and the sum
    EXPECT_DOUBLE_EQ(energy_of_one_second(root).value().joules, 4.96);
  }
}

TEST(DeviceInfo, ReadsThor) {
  const TemporaryFolder root;
  write_thor(root);
  const DeviceInfo device = device_info(root.path());
  EXPECT_EQ(device.jetpack, "JetPack 7 (L4T R38.2.0)");
  ASSERT_EQ(device.power_rails.size(), 4u);
  EXPECT_FALSE(device.power_rails[0].power_w);  // -0.4 W
  EXPECT_DOUBLE_EQ(energy_of_one_second(root).value().joules, 23.5);
}

TEST(DeviceInfo, ReadsALaptop) {
  const TemporaryFolder root;
  write_laptop(root, "5000000");
  const DeviceInfo device = device_info(root.path());
  EXPECT_EQ(device.model, "Laptop");
  EXPECT_DOUBLE_EQ(device.frequency_limit_mhz.value(), 4200.0);
  EXPECT_FALSE(device.nvpmodel);
  EXPECT_FALSE(device.jetpack);
  ASSERT_EQ(device.energy_counters.size(), 1u);  // without subzones, psys and the second interface
  EXPECT_EQ(device.energy_counters[0].name, "package-0");
}

TEST(DeviceInfo, IsEmptyWithoutFiles) {
  const TemporaryFolder root;
  const nlohmann::ordered_json json = device_json(device_info(root.path()));
  for (const auto& [key, value] : json.items()) EXPECT_TRUE(value.is_null() || value.empty()) << key;
}

TEST(PowerRails, WithoutAValidValueGiveNoEnergy) {
  for (const char* current : {"", "-20", "12x", "1 2", "0x10", "1e3", "99999999999999999999", "9000000000"}) {
    const TemporaryFolder root;
    write_jetpack5(root);
    write_hwmon_rail(root, kHwmonFolder, 1, "VDD_IN", "4960", current);
    EXPECT_FALSE(energy_of_one_second(root)) << '"' << current << '"';
  }
}

TEST(PowerRails, ThatAreNotReadableGiveNoEnergy) {
  const TemporaryFolder root;
  write_jetpack5(root);
  std::filesystem::remove(root.path() / kHwmonFolder / "curr1_input");
  std::filesystem::create_directory(root.path() / kHwmonFolder / "curr1_input");  // cannot be read as a file
  EXPECT_FALSE(energy_of_one_second(root));
}

TEST(PowerRails, AreNotSummedIfOneIsMissing) {
  const TemporaryFolder root;
  write_jetpack4(root);
  std::filesystem::remove(root.path() / kIioFolder / "in_power1_input");
  EXPECT_FALSE(energy_of_one_second(root));
}

TEST(PowerRails, ThatFailDuringTheMeasurementGiveNoEnergy) {
  const TemporaryFolder root;
  write_jetpack5(root);
  EnergyMeter meter(root.path(), {}, {});
  meter.sample(EnergyMeter::Time{} + std::chrono::seconds(1));
  write_hwmon_rail(root, kHwmonFolder, 1, "VDD_IN", "garbage", "1000");
  meter.sample(EnergyMeter::Time{} + std::chrono::seconds(2));
  write_jetpack5(root);  // valid again: the energy of the gap remains unknown
  EXPECT_FALSE(meter.use(EnergyMeter::Time{} + std::chrono::seconds(3)));
}

TEST(EnergyCounters, WrapAroundAtTheirRange) {
  const TemporaryFolder root;
  write_laptop(root, "262143000000");
  EnergyMeter meter(root.path(), {}, {});
  write_laptop(root, "671150");  // 328850 to the end of the range, then 671150
  EXPECT_DOUBLE_EQ(meter.use({}).value().joules, 1.0);
}

TEST(EnergyCounters, WithoutARangeGiveNoEnergyAfterAWrapAround) {
  const TemporaryFolder root;
  write_laptop(root, "1000000");
  root.write("sys/class/powercap/intel-rapl:0/max_energy_range_uj", "unknown\n");
  EnergyMeter meter(root.path(), {}, {});
  root.write("sys/class/powercap/intel-rapl:0/energy_uj", "500000\n");
  EXPECT_FALSE(meter.use({}));
}

TEST(EnergyCounters, ThatAreWrongGiveNoEnergy) {
  for (const char* energy : {"", "-5", "12a", "99999999999999999999", "262143328851"}) {
    const TemporaryFolder root;
    write_laptop(root, energy);
    EXPECT_FALSE(energy_of_one_second(root)) << '"' << energy << '"';
  }
}

TEST(EnergyCounters, OfAPackageThatAppearsGiveNoEnergy) {
  const TemporaryFolder root;
  write_laptop(root, "1000000");
  EnergyMeter meter(root.path(), {}, {});
  write_rapl_zone(root, "intel-rapl:2", "package-1", "10");
  EXPECT_FALSE(meter.use({}));
}

}  // namespace
}  // namespace stillpoint::bench
