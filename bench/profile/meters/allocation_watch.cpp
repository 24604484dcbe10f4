// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/allocation_watch.h"

#include <algorithm>

namespace stillpoint::bench {

void AllocationWatch::end_frame() {
  const std::optional<std::size_t> now = allocations_so_far();
  if (at_start_ && now) per_frame_.push_back(*now - *at_start_);
}

std::optional<AllocationCounts> AllocationWatch::counts() const {
  if (per_frame_.empty()) return std::nullopt;
  std::vector<std::size_t> sorted = per_frame_;
  std::ranges::sort(sorted);
  return AllocationCounts{.median = sorted[sorted.size() / 2], .largest = sorted.back()};
}

}  // namespace stillpoint::bench
