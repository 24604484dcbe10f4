// SPDX-License-Identifier: BSD-3-Clause
/// What this process and its threads have taken from the machine, and which processors they may take it from.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace stillpoint {

/// Processor time of one thread, in steps of the kernel's clock (often 10 ms).
struct ThreadUsage {
  std::string name;
  double user_s = 0.0;
  double system_s = 0.0;
};

/// Counts since the process began, or between two moments.
struct ProcessUsage {
  double user_s = 0.0;
  double system_s = 0.0;
  std::int64_t waits = 0;        ///< context switches because a thread had to wait
  std::int64_t preemptions = 0;  ///< context switches because another was given the processor
  std::int64_t minor_faults = 0;
  std::int64_t major_faults = 0;  ///< page faults that needed the disk
  std::int64_t peak_memory_bytes = 0;
};

/// Source: getrusage(2).
[[nodiscard]] ProcessUsage process_usage();

/// `after` less `before`; the peak of memory is that of the whole process.
[[nodiscard]] ProcessUsage usage_between(const ProcessUsage& before, const ProcessUsage& after);

/// By thread id; threads that have ended are not there any more.
[[nodiscard]] std::map<int, ThreadUsage> thread_usages();

/// @param stat text of /proc/PID/task/TID/stat, see proc(5)
/// @param ticks_per_s of the times in it
/// @throws InputError if it is anything else
[[nodiscard]] ThreadUsage parse_thread_stat(const std::string& stat, double ticks_per_s);

/// Restricts this thread, and all that it starts later, to some processors.
/// @throws InputError if the system refuses
void pin_to(const std::vector<int>& processors);

[[nodiscard]] nlohmann::ordered_json usage_json(const ProcessUsage& usage,
                                                const std::map<int, ThreadUsage>& threads);

}  // namespace stillpoint
