// SPDX-License-Identifier: BSD-3-Clause
// Energy and power readings from recorded files: Xavier NX with JetPack 5, AGX Xavier with JetPack 4, laptop.
#include "bench/profile/meters/device_info.h"

#include <gtest/gtest.h>

#include "bench/profile/meters/run_monitor.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temporary_folder.h"

namespace stillpoint::bench {
namespace {

/// Writes a recorded file of one line below the folder.
void record(const TemporaryFolder& root, const std::string& file, const std::string& text) {
  root.write(file, text + "\n");
}

void record_rapl(const TemporaryFolder& root, const std::string& energy_uj) {
  const std::string zone = "sys/class/powercap/intel-rapl:0/";
  record(root, zone + "name", "package-0");
  record(root, zone + "energy_uj", energy_uj);
  record(root, zone + "max_energy_range_uj", "262143328850");
  record(root, "sys/class/powercap/intel-rapl:0:0/energy_uj", "111");  // the cores, within the package
}

void record_hwmon(const TemporaryFolder& root) {
  const std::string folder = "sys/bus/i2c/drivers/ina3221/7-0040/hwmon/hwmon3/";
  record(root, folder + "in1_label", "VDD_IN");
  record(root, folder + "in1_input", "4960");    // mV
  record(root, folder + "curr1_input", "1000");  // mA
  record(root, folder + "in2_label", "VDD_CPU_GPU_CV");
  record(root, folder + "in2_input", "4952");
  record(root, folder + "curr2_input", "250");
}

TEST(Rapl, CountsPackagesWithoutSubzones) {
  const TemporaryFolder root;
  record_rapl(root, "5000000");
  const std::vector<EnergyCounter> before = read_rapl(root.path());
  ASSERT_EQ(before.size(), 1u);
  EXPECT_EQ(before[0].name, "package-0");
  record_rapl(root, "7500000");
  EXPECT_DOUBLE_EQ(joules_between(before, read_rapl(root.path())).value(), 2.5);
}

TEST(Rapl, HandlesCounterWrapAround) {
  const std::vector<EnergyCounter> before = {{.name = "package-0", .energy_uj = 900, .range_uj = 1000}};
  const std::vector<EnergyCounter> after = {{.name = "package-0", .energy_uj = 50, .range_uj = 1000}};
  EXPECT_DOUBLE_EQ(joules_between(before, after).value(), 150e-6);  // 100 to the end of the range, then 50
}

TEST(Ina3221, IsReadWithTheHwmonDriver) {
  const TemporaryFolder root;
  record_hwmon(root);
  const std::vector<RailPower> rails = read_power_sensors(root.path());
  ASSERT_EQ(rails.size(), 2u);
  EXPECT_EQ(rails[0].rail, "VDD_IN");
  EXPECT_DOUBLE_EQ(rails[0].power_w.value(), 4.96);  // 4.96 V x 1 A
  EXPECT_DOUBLE_EQ(rails[1].power_w.value(), 1.238);
  EXPECT_DOUBLE_EQ(device_power_w(rails).value(), 4.96);  // the other rail is fed by it
}

TEST(Ina3221, IsReadWithTheIioDriver) {
  const TemporaryFolder root;
  const std::string folder = "sys/bus/i2c/drivers/ina3221x/1-0040/iio:device0/";
  record(root, folder + "rail_name_0", "GPU");
  record(root, folder + "in_power0_input", "1242");
  record(root, folder + "rail_name_1", "CPU");
  record(root, folder + "in_power1_input", "621");
  EXPECT_DOUBLE_EQ(device_power_w(read_power_sensors(root.path())).value(),
                   1.863);  // no rail feeds the others
}

TEST(Tegrastats, ParsesTheFormatOfJetPack5) {
  const std::vector<RailPower> rails = parse_tegrastats(
      "03-14-2023 10:15:36 RAM 2457/6854MB (lfb 2x4MB) SWAP 0/3427MB (cached 0MB) CPU "
      "[12%@1190,off,off,3%@1190] EMC_FREQ 2%@1600 GR3D_FREQ 0%@114 GPU@41.5C PMIC@50C "
      "VDD_IN 4060mW/4120mW VDD_CPU_GPU_CV 500mW/512mW VDD_SOC 1216mW/1216mW");
  ASSERT_EQ(rails.size(), 3u);  // without memory usage
  EXPECT_EQ(rails[0].rail, "VDD_IN");
  EXPECT_DOUBLE_EQ(rails[0].power_w.value(), 4.06);
  EXPECT_DOUBLE_EQ(device_power_w(rails).value(), 4.06);
}

TEST(Tegrastats, ParsesTheFormatOfJetPack4) {
  const std::vector<RailPower> rails = parse_tegrastats(
      "RAM 2318/15692MB (lfb 2885x4MB) CPU [1%@1190,0%@1190] EMC_FREQ 0% GR3D_FREQ 0% AO@36.5C "
      "GPU 0/0 CPU 621/595 SOC 932/932 CV 0/0 VDDRQ 155/142 SYS5V 1400/1400");
  ASSERT_EQ(rails.size(), 6u);
  EXPECT_EQ(rails[5].rail, "SYS5V");
  EXPECT_NEAR(device_power_w(rails).value(), 3.108, 1e-12);  // 0 + 621 + 932 + 0 + 155 + 1400 mW
}

TEST(Tegrastats, TextWithoutARailIsNoLog) {
  const TemporaryFolder root;
  expect_input_error([&] { require_tegrastats(root.write("notes", "first\nsecond 1/x\n")); },
                     {"notes:2", "VDD_IN 4060mW/4060mW", "--logfile"});
  EXPECT_NO_THROW(require_tegrastats(root.write("log", "RAM 1/2MB VDD_IN 4000mW/6000mW\n")));
  EXPECT_NO_THROW(require_tegrastats(root.write("new", "RAM 1/2MB VDD")));  // no complete line yet
}

TEST(EnergyMeter, IntegratesPowerOverTime) {
  const TemporaryFolder root;
  record_hwmon(root);
  const EnergyMeter::Time start{};
  EnergyMeter meter(root.path(), {}, start);
  meter.sample(start + std::chrono::seconds(2));
  const std::optional<EnergyUse> use = meter.use(start + std::chrono::seconds(3));
  ASSERT_TRUE(use);
  EXPECT_EQ(use->source, "INA3221");
  EXPECT_NEAR(use->joules, 3 * 4.96, 1e-9);
}

TEST(EnergyMeter, PrefersCounters) {
  const TemporaryFolder root;
  record_hwmon(root);
  record_rapl(root, "1000000");
  EnergyMeter meter(root.path(), {}, {});
  record_rapl(root, "4000000");
  const std::optional<EnergyUse> use = meter.use(EnergyMeter::Time{} + std::chrono::seconds(1));
  ASSERT_TRUE(use);
  EXPECT_EQ(use->source, "RAPL");
  EXPECT_DOUBLE_EQ(use->joules, 3.0);
}

TEST(EnergyMeter, ReadsTheTegrastatsLogWithoutSensors) {
  const TemporaryFolder root;
  // The last line is still being written.
  const auto log = root.write("log", "VDD_IN 9000mW/9000mW\nVDD_IN 4000mW/6000mW\nVDD_IN 70");
  EnergyMeter meter(root.path(), log, {});
  const std::optional<EnergyUse> use = meter.use(EnergyMeter::Time{} + std::chrono::seconds(2));
  ASSERT_TRUE(use);
  EXPECT_EQ(use->source, "tegrastats");
  EXPECT_DOUBLE_EQ(use->joules, 8.0);
}

TEST(EnergyMeter, HasNoResultWithoutASource) {
  const TemporaryFolder root;
  EnergyMeter meter(root.path(), {}, {});
  EXPECT_FALSE(meter.use(EnergyMeter::Time{} + std::chrono::seconds(1)));
}

}  // namespace
}  // namespace stillpoint::bench
