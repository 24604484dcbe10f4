// SPDX-License-Identifier: BSD-3-Clause
/// What `stillpoint profile` found out about a run, for people and for programs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/profile/allocation_watch.h"
#include "bench/profile/energy_meter.h"
#include "bench/profile/hardware_counters.h"
#include "bench/profile/process_usage.h"
#include "bench/profile/profile_table.h"
#include "bench/profile/recorder_cost.h"

namespace stillpoint {

/// One run with all that was measured.
struct Profile {
  OdometryRun run;
  std::vector<ProfileRow> rows;
  DeadlineMisses misses;
  ProcessUsage usage;
  std::map<int, ThreadUsage> threads;
  std::optional<AllocationCounts> allocations;  ///< where the program counts them
  std::vector<HardwareCount> counters;
  std::string counters_missing;     ///< why there are none
  std::optional<EnergyUse> energy;  ///< where the machine tells
  RecorderCost recorder;
};

/// Which run it is.
struct ProfileTitle {
  std::string sequence;
  std::string base;
  std::string variant;
  std::string mode;
  std::string cores;
};

/// Text of profile.json; what could not be measured is null.
[[nodiscard]] std::string profile_text(const Profile& profile, const ProfileTitle& title);

/// To the standard output; what could not be measured is "n/a" with the reason.
void print_profile(const Profile& profile);

}  // namespace stillpoint
