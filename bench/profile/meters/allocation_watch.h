// SPDX-License-Identifier: BSD-3-Clause
/// Heap allocations per frame, in programs that count them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace stillpoint::bench {

/// Allocations of all threads since program start; nothing in a program that does not count them.
/// Two files define it: allocations_counted.cpp and allocations_uncounted.cpp; a program links one.
[[nodiscard]] std::optional<std::size_t> allocations_so_far();

struct AllocationCounts {
  std::size_t median = 0;
  std::size_t largest = 0;
};

class AllocationWatch {
 public:
  /// Allocations between `end_frame` and the next `begin_frame` are not counted.
  void end_frame();
  void begin_frame() { at_start_ = allocations_so_far(); }

  /// Nothing in a program that does not count allocations, and without frames.
  [[nodiscard]] std::optional<AllocationCounts> counts() const;

 private:
  std::optional<std::size_t> at_start_ = allocations_so_far();  ///< count at the start of the frame
  std::vector<std::size_t> per_frame_;
};

}  // namespace stillpoint::bench
