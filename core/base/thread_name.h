// SPDX-License-Identifier: BSD-3-Clause
/// Names of threads, as debuggers and /proc show them.
#pragma once

#include <pthread.h>

namespace stillpoint {

/// @param name at most 15 characters: a longer one is not taken
inline void name_this_thread(const char* name) { pthread_setname_np(pthread_self(), name); }

}  // namespace stillpoint
