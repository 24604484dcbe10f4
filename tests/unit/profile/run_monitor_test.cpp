// SPDX-License-Identifier: BSD-3-Clause
// Energy per frame and throttling of a run.
#include "bench/profile/meters/run_monitor.h"

#include <gtest/gtest.h>

#include "tests/support/sysfs_trees.h"

namespace stillpoint::bench {
namespace {

/// Samples at 20 Hz of a machine with constant power that processes 10 frames per second.
std::vector<EnergySample> constant_power(double power_w, double duration_s, double interval_s = 0.05) {
  std::vector<EnergySample> samples;
  for (int i = 0; i * interval_s <= duration_s + 1e-9; ++i) {
    const double t_s = i * interval_s;
    samples.push_back(
        {.t_s = t_s, .joules = power_w * t_s, .frames = static_cast<std::int64_t>(10.0 * t_s + 1e-6)});
  }
  return samples;
}

TEST(EnergyScore, SubtractsIdlePower) {
  const DeviceScore score = energy_score(constant_power(7.0, 3.0), 2.0);
  EXPECT_NEAR(score.joules_per_frame.value(), 0.5, 1e-9);  // (7 - 2) W * 3 s / 30 frames
  EXPECT_NEAR(score.joules_per_frame_sd.value(), 0.0, 1e-9);
  EXPECT_NEAR(score.power_w.value(), 7.0, 1e-9);
  EXPECT_NEAR(score.energy_rate_hz.value(), 20.0, 1e-9);
}

TEST(EnergyScore, ReportsTheSpreadOverSeconds) {
  std::vector<EnergySample> samples = constant_power(7.0, 2.0);
  for (EnergySample& sample : samples) sample.joules += std::max(0.0, sample.t_s - 1.0) * 4.0;  // then 11 W
  // 0.5 and 0.9 J: their standard deviation is 0.4 / sqrt(2).
  EXPECT_NEAR(energy_score(samples, 2.0).joules_per_frame_sd.value(), 0.282842712, 1e-6);
}

TEST(EnergyScore, HasNoEnergyBelowTenHertz) {
  EXPECT_FALSE(energy_score(constant_power(7.0, 3.0, 0.2), 2.0).joules_per_frame);
}

TEST(EnergyScore, HasNoEnergyWithoutFramesOrAboveIdle) {
  std::vector<EnergySample> samples = constant_power(7.0, 3.0);
  EXPECT_FALSE(energy_score(samples, 8.0).joules_per_frame);  // less than idle
  for (EnergySample& sample : samples) sample.frames = 0;
  EXPECT_FALSE(energy_score(samples, 2.0).joules_per_frame);
  EXPECT_FALSE(energy_score({}, 2.0).joules_per_frame);
}

TEST(Throttling, IsAnEventOrALowerLimitOrMoreCooling) {
  const TemporaryFolder root;
  write_laptop(root, "1");
  const std::string cooling = "sys/class/thermal/cooling_device0/";
  root.write(cooling + "type", "thermal-cpufreq-0\n");
  root.write(cooling + "cur_state", "0\n");
  root.write("sys/class/thermal/cooling_device1/type", "pwm-fan\n");
  root.write("sys/class/thermal/cooling_device1/cur_state", "1\n");
  const ThrottleState before = read_throttle_state(root.path());
  root.write("sys/class/thermal/cooling_device1/cur_state", "3\n");  // a faster fan limits nothing
  EXPECT_EQ(throttled_between(before, read_throttle_state(root.path())), false);
  const auto is_throttled_by = [&](const std::string& file, const char* value, const char* normal) {
    root.write(file, value);
    const auto throttled = throttled_between(before, read_throttle_state(root.path()));
    root.write(file, normal);
    return throttled;
  };
  const std::string cpu = "sys/devices/system/cpu/";
  EXPECT_EQ(is_throttled_by(cpu + "cpu0/thermal_throttle/core_throttle_count", "8", "7"), true);
  EXPECT_EQ(is_throttled_by(cpu + "cpufreq/policy0/scaling_max_freq", "4100000", "4200000"), true);
  EXPECT_EQ(is_throttled_by(cooling + "cur_state", "2", "0"), true);
}

TEST(Throttling, IsUnknownWithoutFiles) {
  const TemporaryFolder root;
  EXPECT_FALSE(throttled_between(read_throttle_state(root.path()), read_throttle_state(root.path())));
}

TEST(RunMonitor, MeasuresNothingWithoutFiles) {
  const TemporaryFolder root;
  RunMonitor monitor(root.path());
  EXPECT_FALSE(monitor.finish());
}

TEST(RunMonitor, ReportsThrottlingWithoutRails) {
  const TemporaryFolder root;
  write_processors(root, "0-7", "powersave", "4200000");
  RunMonitor monitor(root.path());
  write_processors(root, "0-7", "powersave", "3000000");
  const std::optional<DeviceScore> score = monitor.finish();
  ASSERT_TRUE(score);
  EXPECT_EQ(score->throttled, 1.0);
  EXPECT_FALSE(score->joules_per_frame);
}

}  // namespace
}  // namespace stillpoint::bench
