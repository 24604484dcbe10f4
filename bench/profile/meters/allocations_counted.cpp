// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/meters/allocation_counter.h"
#include "bench/profile/meters/allocation_watch.h"

namespace stillpoint::bench {

std::optional<std::size_t> allocations_so_far() { return allocation_count(); }

}  // namespace stillpoint::bench
