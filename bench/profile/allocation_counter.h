// SPDX-License-Identifier: BSD-3-Clause
/// Counts requests for heap memory, in programs linked with allocation_counter.cpp and its --wrap options.
#pragma once

#include <cstddef>

namespace stillpoint {

/// Calls of malloc, calloc, realloc, aligned_alloc and operator new by all threads since the program began;
/// those inside shared libraries are not seen.
[[nodiscard]] std::size_t allocation_count();

}  // namespace stillpoint
