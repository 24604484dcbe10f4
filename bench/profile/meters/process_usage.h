// SPDX-License-Identifier: BSD-3-Clause
/// What the kernel counts: resource usage of this process and its threads, hardware performance counters, and
/// the load of the machine. Also the CPU affinity, on which these depend.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/model/metrics.h"

namespace stillpoint::bench {

/// Processor time of one thread, in steps of the kernel's clock (often 10 ms).
struct ThreadUsage {
  std::string name;
  double user_s = 0.0;
  double system_s = 0.0;
};

/// Counts since process start, or between two readings.
struct ProcessUsage {
  double user_s = 0.0;
  double system_s = 0.0;
  std::int64_t voluntary_switches = 0;    ///< context switches of waiting threads
  std::int64_t involuntary_switches = 0;  ///< context switches by preemption
  std::int64_t minor_faults = 0;
  std::int64_t major_faults = 0;  ///< page faults that required I/O
  std::int64_t peak_memory_bytes = 0;
};

/// Source: getrusage(2).
[[nodiscard]] ProcessUsage process_usage();

/// `after` - `before`; the peak memory is that of the whole process.
[[nodiscard]] ProcessUsage usage_between(const ProcessUsage& before, const ProcessUsage& after);

/// Time since this process was started, in steps of the kernel's clock; 0 if /proc is not available.
[[nodiscard]] double process_age_s();

/// By thread id; without threads that have exited.
[[nodiscard]] std::map<int, ThreadUsage> thread_usages();

/// @param stat text of /proc/PID/task/TID/stat, see proc(5)
/// @param ticks_per_s clock ticks per second, the unit of its times
/// @throws InputError if the text has another format
[[nodiscard]] ThreadUsage parse_thread_stat(const std::string& stat, double ticks_per_s);

/// Sets the CPU affinity of this thread and of threads that it starts later.
/// @throws InputError if the system refuses
void pin_to(const std::vector<int>& processors);

[[nodiscard]] nlohmann::ordered_json usage_json(const ProcessUsage& usage,
                                                const std::map<int, ThreadUsage>& threads);

struct HardwareCount {
  std::string name;  ///< e.g. "instructions"
  std::int64_t count = 0;
};

/// Hardware performance counters, if the machine and its settings allow them. Counts in user mode for this
/// thread and the threads that it starts after construction.
/// Source: perf_event_open(2).
class HardwareCounters {
 public:
  HardwareCounters();
  ~HardwareCounters();
  HardwareCounters(const HardwareCounters&) = delete;
  HardwareCounters& operator=(const HardwareCounters&) = delete;

  /// Current counts; empty if no counter is available.
  [[nodiscard]] std::vector<HardwareCount> counts() const;

  /// Why no counter is available; empty if one is.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  struct Counter {
    const char* name;
    int descriptor;
  };
  std::vector<Counter> counters_;
  std::string reason_;
};

/// Describes an error of perf_event_open for the user.
[[nodiscard]] std::string describe_counter_error(int error_number);

/// Load of the machine: processor time since boot [ticks of sysconf(_SC_CLK_TCK)], summed over all
/// processors.
struct MachineLoad {
  std::int64_t busy = 0;
  std::int64_t total = 0;
};

[[nodiscard]] MachineLoad machine_load();

/// @param stat text of /proc/stat (proc(5)); user time includes guest time
[[nodiscard]] MachineLoad parse_machine_load(std::string_view stat);

/// The metrics of source `MetricSource::kMachine`: load by other processes between two measurements. Empty if
/// /proc/stat is not available.
/// @param own_s processor time of the timed process [s]
[[nodiscard]] std::vector<Metric> load_metrics(const MachineLoad& before, const MachineLoad& after,
                                               double own_s);

}  // namespace stillpoint::bench
