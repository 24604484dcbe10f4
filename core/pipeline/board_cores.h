// SPDX-License-Identifier: BSD-3-Clause
/// When the cores of a board are free.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace stillpoint {

/// Work is given to the core that is free first, in the order in which it is asked for, and is not
/// interrupted.
class BoardCores {
 public:
  using Time = std::chrono::nanoseconds;  ///< since the first picture

  /// @param count at least 1
  explicit BoardCores(int count) : free_at_(static_cast<std::size_t>(count), Time{}) {}

  /// Does work that can begin at `ready`. @return when it ends
  [[nodiscard]] Time occupy(Time ready, Time cost) {
    const auto core = std::ranges::min_element(free_at_);
    *core = std::max(ready, *core) + cost;
    return *core;
  }

 private:
  std::vector<Time> free_at_;
};

}  // namespace stillpoint
