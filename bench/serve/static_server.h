// SPDX-License-Identifier: BSD-3-Clause
/// HTTP server of in-memory files and of a stream of events; requests never access the file
/// system. Old connections are closed in favor of new ones.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "bench/record/output_folder.h"
#include "bench/serve/event_streams.h"

struct MHD_Daemon;

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

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< IPv4; the default is accessible from this machine only
  int port = 8035;                    ///< 0 = any free port
};

/// Serves GET and HEAD requests in one background thread until it is destroyed. At most 32 connections with
/// 32 kB of memory each; larger requests are rejected. A connection serves one request; idle ones are closed
/// after 5 s, and the oldest one when there are too many. On a loopback address the Host header must name
/// this machine, which protects against DNS rebinding by other sites. Streams of events stay open; there are
/// at most `EventStreams::kMaxStreams`, and they do not count as connections.
class StaticServer {
 public:
  /// Path of the stream of events; it exists from the first `publish` on.
  static constexpr const char* kEvents = "/events";

  /// @param files names are request paths; "index.html" is served for its folder
  /// @throws InputError if the address is invalid or already in use
  StaticServer(const std::vector<OutputFile>& files, const ServerOptions& options);

  ~StaticServer();
  StaticServer(const StaticServer&) = delete;  // the server thread holds a pointer to it
  StaticServer& operator=(const StaticServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;

  /// Replaces all files; responses that are being sent are completed with the old ones. Thread-safe.
  void replace(const std::vector<OutputFile>& files);

  /// Sends a message, one line, to all streams of events; those that are opened later begin with it.
  /// Thread-safe.
  void publish(const std::string& message) { events_.publish(message); }

  struct Response {
    unsigned status = 200;
    std::shared_ptr<const std::string> text;  ///< null: the stream of events
    std::string type;                         ///< MIME type
  };
  /// @param path of the request, without percent encoding
  /// @param host Host header of the request, empty if absent
  [[nodiscard]] Response respond(const std::string& method, const std::string& path,
                                 const std::string& host) const;

 private:
  using Texts = std::map<std::string, std::shared_ptr<const std::string>>;

  struct Requests;  ///< callbacks of the server thread

  mutable std::mutex mutex_;  ///< guards `texts_`
  Texts texts_;               ///< by path, e.g. "/index.html"
  std::string address_;
  ConnectionLimit connections_;  ///< used by the server thread
  EventStreams events_;
  std::unique_ptr<MHD_Daemon, void (*)(MHD_Daemon*)> daemon_;
};

}  // namespace stillpoint::bench
