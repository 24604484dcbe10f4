// SPDX-License-Identifier: BSD-3-Clause
/// Hardware performance counters, if the machine and its settings allow them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stillpoint::bench {

struct HardwareCount {
  std::string name;  ///< e.g. "instructions"
  std::int64_t count = 0;
};

/// Counts in user mode for this thread and the threads that it starts after construction.
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

}  // namespace stillpoint::bench
