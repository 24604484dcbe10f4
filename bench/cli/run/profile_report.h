// SPDX-License-Identifier: BSD-3-Clause
/// Output of `stillpoint profile`: JSON file and console text, with --duration also the drift of times and
/// temperature while the run is repeated.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/profile/meters/allocation_watch.h"
#include "bench/profile/meters/process_usage.h"
#include "bench/profile/meters/run_monitor.h"
#include "bench/profile/profile_table.h"

namespace stillpoint::bench {

/// One repetition of the run.
struct DriftRow {
  double t_s = 0.0;       ///< end of the repetition, since the start of the first
  double frame_ms = 0.0;  ///< mean time of all stages per frame
  std::optional<double> temperature_c{};
  std::optional<bool> throttled{};  ///< during the repetition
};

/// "90s", "10m" or "1h", with an optional fraction [s].
/// @param text   value of an option
/// @param option its name, in messages
/// @throws InputError unless the text is a positive number with one of these units
[[nodiscard]] double parse_duration_s(std::string_view text, const std::string& option);

/// Null for values that are not available.
[[nodiscard]] nlohmann::ordered_json drift_json(const std::vector<DriftRow>& rows);

/// The trend of the times over all repetitions (Mann-Kendall test, see eval/statistics/change_points.h), and
/// the change of the temperature from the first to the last one; "n/a" for values that are not available;
/// empty without rows.
[[nodiscard]] std::string drift_text(const std::vector<DriftRow>& rows);

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
  std::vector<DriftRow> drift;       ///< with --duration
  std::optional<double> other_load;  ///< CPU load by other processes, 0 to 1; see metric "quiet"
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
