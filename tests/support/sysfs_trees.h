// SPDX-License-Identifier: BSD-3-Clause
/// Made-up files of /sys, /proc, /etc and /var as Jetson devices and a laptop have them.
#pragma once

#include <string>

#include "tests/support/temporary_folder.h"

namespace stillpoint {

/// An INA3221 channel with the kernel driver hwmon: mV and mA.
inline void write_hwmon_rail(const TemporaryFolder& root, const std::string& folder, int channel,
                             const std::string& label, const std::string& millivolts,
                             const std::string& milliamperes) {
  const std::string number = std::to_string(channel);
  root.write(folder + "/in" + number + "_label", label + "\n");
  root.write(folder + "/in" + number + "_input", millivolts + "\n");
  root.write(folder + "/curr" + number + "_input", milliamperes + "\n");
}

inline const std::string kIioFolder = "sys/bus/i2c/drivers/ina3221x/1-0040/iio:device0";
inline const std::string kHwmonFolder = "sys/bus/i2c/drivers/ina3221/1-0040/hwmon/hwmon3";

inline void write_thermal_zone(const TemporaryFolder& root, int index, const std::string& type,
                               const std::string& temperature) {
  const std::string folder = "sys/class/thermal/thermal_zone" + std::to_string(index);
  root.write(folder + "/type", type + "\n");
  root.write(folder + "/temp", temperature + "\n");
}

inline void write_processors(const TemporaryFolder& root, const std::string& online,
                             const std::string& governor, const std::string& limit_khz) {
  root.write("sys/devices/system/cpu/online", online + "\n");
  root.write("sys/devices/system/cpu/present", "0-7\n");
  root.write("sys/devices/system/cpu/cpufreq/policy0/scaling_governor", governor + "\n");
  root.write("sys/devices/system/cpu/cpufreq/policy0/scaling_max_freq", limit_khz + "\n");
}

inline void write_nvpmodel(const TemporaryFolder& root, const std::string& mode) {
  root.write("var/lib/nvpmodel/status", "pmode:" + mode + "\n");
  root.write("etc/nvpmodel.conf",
             "# comment\n< POWER_MODEL ID=0 NAME=MAXN >\nCPU_ONLINE CORE_0 1\n< POWER_MODEL ID=2 "
             "NAME=MODE_15W >\n");
}

/// AGX Xavier with JetPack 4: rails by iio, no input rail; the total is 1.863 W.
inline void write_jetpack4(const TemporaryFolder& root) {
  root.write("etc/nv_tegra_release", "# R32 (release), REVISION: 7.1, GCID: 29818004\n");
  root.write("proc/device-tree/model", std::string("Jetson-AGX\0", 11));
  write_processors(root, "0-3", "schedutil", "2265600");
  write_nvpmodel(root, "0002");
  write_thermal_zone(root, 0, "CPU-therm", "41500");
  write_thermal_zone(root, 1, "GPU-therm", "-256000");  // without power
  root.write(kIioFolder + "/rail_name_0", "GPU\n");
  root.write(kIioFolder + "/in_power0_input", "1242\n");
  root.write(kIioFolder + "/rail_name_1", "CPU\n");
  root.write(kIioFolder + "/in_power1_input", "621\n");
}

/// Orin with JetPack 5 or 6: rails by hwmon, the input rail has 4.96 W.
inline void write_jetpack5(const TemporaryFolder& root,
                           const std::string& release = "# R35 (release), REVISION: 4.1,") {
  root.write("etc/nv_tegra_release", release + " GCID: 33958178\n");
  write_processors(root, "0-7", "schedutil", "1510400");
  write_nvpmodel(root, "0000");
  write_thermal_zone(root, 0, "cpu-thermal", "47031");
  write_hwmon_rail(root, kHwmonFolder, 1, "VDD_IN", "4960", "1000");
  write_hwmon_rail(root, kHwmonFolder, 2, "VDD_CPU_GPU_CV", "4952", "250");
  write_hwmon_rail(root, kHwmonFolder, 3, "NC", "0", "0");
  root.write(kHwmonFolder + "/in7_label", "sum of shunt voltages\n");
}

/// Thor: an INA3221 whose GPU channel has a negative offset, and an INA238 at the input with 23.5 W.
inline void write_thor(const TemporaryFolder& root) {
  root.write("etc/nv_tegra_release", "# R38 (release), REVISION: 2.0, GCID: 41844464\n");
  const std::string folder = "sys/bus/i2c/drivers/ina3221/2-0040/hwmon/hwmon4";
  write_hwmon_rail(root, folder, 1, "VDD_GPU", "19600", "-20");
  write_hwmon_rail(root, folder, 2, "VDD_CPU_SOC_MSS", "19600", "200");
  write_hwmon_rail(root, folder, 3, "VIN_SYS_5V0", "5000", "1300");
  root.write("sys/bus/i2c/drivers/ina238/2-0044/hwmon/hwmon5/power1_input", "23500000\n");
}

inline void write_rapl_zone(const TemporaryFolder& root, const std::string& zone, const std::string& name,
                            const std::string& energy_uj) {
  const std::string folder = "sys/class/powercap/" + zone;
  root.write(folder + "/name", name + "\n");
  root.write(folder + "/energy_uj", energy_uj + "\n");
  root.write(folder + "/max_energy_range_uj", "262143328850\n");
}

/// Laptop with one package; the platform ("psys") and a second interface count the same energy again.
inline void write_laptop(const TemporaryFolder& root, const std::string& energy_uj) {
  root.write("sys/class/dmi/id/product_name", "Laptop\n");
  write_processors(root, "0-7", "powersave", "4200000");
  root.write("sys/devices/system/cpu/cpu0/thermal_throttle/core_throttle_count", "7\n");
  write_thermal_zone(root, 0, "x86_pkg_temp", "52000");
  write_rapl_zone(root, "intel-rapl:0", "package-0", energy_uj);
  write_rapl_zone(root, "intel-rapl:0:0", "core", "111");
  write_rapl_zone(root, "intel-rapl:1", "psys", "999999");
  write_rapl_zone(root, "intel-rapl-mmio:0", "package-0", energy_uj);
}

}  // namespace stillpoint
