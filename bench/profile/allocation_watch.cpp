// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/allocation_watch.h"

#include <algorithm>

namespace stillpoint {

void AllocationWatch::end_picture() {
  const std::optional<std::size_t> now = allocations_so_far();
  if (begun_ && now) pictures_.push_back(*now - *begun_);
}

std::optional<AllocationCounts> AllocationWatch::counts() const {
  if (pictures_.empty()) return std::nullopt;
  std::vector<std::size_t> sorted = pictures_;
  std::ranges::sort(sorted);
  return AllocationCounts{.median = sorted[sorted.size() / 2], .largest = sorted.back()};
}

}  // namespace stillpoint
