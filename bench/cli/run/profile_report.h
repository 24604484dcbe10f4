// SPDX-License-Identifier: BSD-3-Clause
/// Output of `stillpoint profile`: JSON file and console text.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/cli/run/profile_drift.h"
#include "bench/profile/meters/allocation_watch.h"
#include "bench/profile/meters/energy_meter.h"
#include "bench/profile/meters/hardware_counters.h"
#include "bench/profile/meters/process_usage.h"
#include "bench/profile/meters/run_monitor.h"
#include "bench/profile/profile_table.h"
#include "bench/profile/recorder_cost.h"

namespace stillpoint::bench {

/// One run with its measurements.
struct Profile {
  OdometryRun run;
  std::vector<ProfileRow> rows;
  DeadlineMisses misses;
  ProcessUsage usage;
  std::map<int, ThreadUsage> threads;
  std::optional<AllocationCounts> allocations;  ///< only in stillpoint_counting
  std::vector<HardwareCount> counters;
  std::string counters_missing;     ///< reason if `counters` is empty
  std::optional<EnergyUse> energy;  ///< if the machine has a readable energy counter
  std::optional<double> idle_w;     ///< power before the run
  DeviceScore energy_above_idle;    ///< see `energy_score`; empty without `idle_w`
  RecorderCost recorder;
  std::vector<DriftRow> drift;  ///< with --duration
};

/// Identification of the profiled run.
struct ProfileTitle {
  std::string sequence;
  std::string base;
  std::string variant;
  std::string mode;
  std::string cores;
};

/// Content of profile.json; null for values that could not be measured.
[[nodiscard]] std::string profile_text(const Profile& profile, const ProfileTitle& title);

/// Prints to stdout; "n/a" with the reason for values that could not be measured.
void print_profile(const Profile& profile);

}  // namespace stillpoint::bench
