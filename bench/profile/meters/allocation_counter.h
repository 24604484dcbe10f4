// SPDX-License-Identifier: BSD-3-Clause
/// Counts heap allocations, in programs linked with allocation_counter.cpp and its --wrap options.
#pragma once

#include <cstddef>
#include <string_view>

namespace stillpoint::bench {

/// Calls of malloc, calloc, realloc, aligned_alloc and operator new by all threads since program start;
/// those inside shared libraries are not counted.
[[nodiscard]] std::size_t allocation_count();

/// Those by the running threads with this name (see core/base/thread_name.h), of the first 64 threads.
[[nodiscard]] std::size_t allocation_count_of(std::string_view thread_name);

}  // namespace stillpoint::bench
