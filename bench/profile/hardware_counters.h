// SPDX-License-Identifier: BSD-3-Clause
/// The processor's own counters, where the machine and its settings give them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace stillpoint {

struct HardwareCount {
  std::string name;  ///< e.g. "instructions"
  std::int64_t count = 0;
};

/// Counts for this thread and those that it starts from the construction on, in user mode.
/// Source: perf_event_open(2).
class HardwareCounters {
 public:
  HardwareCounters();
  ~HardwareCounters();
  HardwareCounters(const HardwareCounters&) = delete;
  HardwareCounters& operator=(const HardwareCounters&) = delete;

  /// So far; empty where there are none.
  [[nodiscard]] std::vector<HardwareCount> counts() const;

  /// Why there are none; empty where there are.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  struct Counter {
    const char* name;
    int descriptor;
  };
  std::vector<Counter> counters_;
  std::string reason_;
};

/// What a failed perf_event_open means to a user.
[[nodiscard]] std::string counters_missing(int error_number);

}  // namespace stillpoint
