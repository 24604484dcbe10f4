// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/allocation_counter.h"
#include "bench/profile/allocation_watch.h"

namespace stillpoint {

std::optional<std::size_t> allocations_so_far() { return allocation_count(); }

}  // namespace stillpoint
