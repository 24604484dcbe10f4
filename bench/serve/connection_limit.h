// SPDX-License-Identifier: BSD-3-Clause
/// Limit on the connections of a server that closes old ones in favor of new ones.
#pragma once

#include <chrono>
#include <cstddef>
#include <map>

namespace stillpoint::bench {

/// The open connections by socket, each for one request. When the limit is exceeded, the oldest connection is
/// shut down: a client that does not complete its requests cannot keep others from being served. Not
/// thread-safe: libmicrohttpd calls it from one thread.
class ConnectionLimit {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ConnectionLimit(std::size_t limit) : limit_(limit) {}

  /// Adds a connection. Shuts down the oldest one above the limit, and all that are older than 10 s. The
  /// owner of a socket that is shut down still has to close it.
  void opened(int socket, Clock::time_point now);

  void closed(int socket) { opened_.erase(socket); }

 private:
  std::size_t limit_;
  std::map<int, Clock::time_point> opened_;  ///< without those that were shut down
};

}  // namespace stillpoint::bench
