// SPDX-License-Identifier: BSD-3-Clause
/// Requests for heap memory, picture by picture, in programs that count them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace stillpoint {

/// Requests of all threads since the program began; nothing in a program that does not count them.
/// Two files define it: allocations_counted.cpp and allocations_uncounted.cpp; a program links one.
[[nodiscard]] std::optional<std::size_t> allocations_so_far();

struct AllocationCounts {
  std::size_t median = 0;
  std::size_t largest = 0;
};

class AllocationWatch {
 public:
  /// Between the two calls nothing is counted.
  void end_picture();
  void begin_picture() { begun_ = allocations_so_far(); }

  /// Nothing in a program that does not count, and without pictures.
  [[nodiscard]] std::optional<AllocationCounts> counts() const;

 private:
  std::optional<std::size_t> begun_ = allocations_so_far();
  std::vector<std::size_t> pictures_;
};

}  // namespace stillpoint
