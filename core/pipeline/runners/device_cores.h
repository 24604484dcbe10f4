// SPDX-License-Identifier: BSD-3-Clause
/// Schedule of the cores of a simulated device.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace stillpoint {

/// Non-preemptive list scheduling: each job runs on the core that becomes free first, in order of the calls.
class DeviceCores {
 public:
  using Time = std::chrono::nanoseconds;  ///< since the first frame

  /// @param count at least 1
  explicit DeviceCores(int count) : free_at_(static_cast<std::size_t>(count), Time{}) {}

  /// Schedules a job that can start at `ready`. @return its end
  [[nodiscard]] Time occupy(Time ready, Time cost) {
    const auto core = std::ranges::min_element(free_at_);
    *core = std::max(ready, *core) + cost;
    return *core;
  }

 private:
  std::vector<Time> free_at_;
};

}  // namespace stillpoint
