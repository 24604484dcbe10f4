// SPDX-License-Identifier: BSD-3-Clause
#include "bench/serve/connection_limit.h"

#include <algorithm>

#include <sys/socket.h>

namespace stillpoint::bench {

void ConnectionLimit::opened(int socket, Clock::time_point now) {
  constexpr std::chrono::seconds kMaxAge{10};
  opened_[socket] = now;
  std::erase_if(opened_, [&](const auto& entry) {
    const bool expired = now - entry.second > kMaxAge;
    if (expired) shutdown(entry.first, SHUT_RDWR);
    return expired;
  });
  if (opened_.size() <= limit_) return;
  const auto oldest =
      std::ranges::min_element(opened_, [](const auto& a, const auto& b) { return a.second < b.second; });
  shutdown(oldest->first, SHUT_RDWR);
  opened_.erase(oldest);
}

}  // namespace stillpoint::bench
