// SPDX-License-Identifier: BSD-3-Clause
/// Thread names as shown by debuggers and /proc.
#pragma once

#include <pthread.h>

namespace stillpoint {

/// @param name at most 15 characters; longer names are ignored
inline void name_this_thread(const char* name) { pthread_setname_np(pthread_self(), name); }

}  // namespace stillpoint
