// SPDX-License-Identifier: BSD-3-Clause
#include "bench/model/utc_time.h"

#include <chrono>

#include <fmt/chrono.h>

namespace stillpoint::bench {

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

}  // namespace stillpoint::bench
