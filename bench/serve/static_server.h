// SPDX-License-Identifier: BSD-3-Clause
/// HTTP server of files that it holds in memory; requests never access the file system. Old connections are
/// closed in favor of new ones.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/record/output_folder.h"

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
/// this machine, which protects against DNS rebinding by other sites.
class StaticServer {
 public:
  /// @param files names are request paths; "index.html" is served for its folder
  /// @throws InputError if the address is invalid or already in use
  StaticServer(const std::vector<OutputFile>& files, const ServerOptions& options);

  StaticServer(const StaticServer&) = delete;  // the server thread holds a pointer to it
  StaticServer& operator=(const StaticServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;

  struct Response {
    unsigned status = 200;
    const std::string* text = nullptr;  ///< valid during the lifetime of the server
    std::string type;                   ///< MIME type
  };
  /// @param path of the request, without percent encoding
  /// @param host Host header of the request, empty if absent
  [[nodiscard]] Response respond(const std::string& method, const std::string& path,
                                 const std::string& host) const;

 private:
  std::map<std::string, std::string> texts_;     ///< by path, e.g. "/index.html"
  std::map<unsigned, std::string> error_texts_;  ///< by HTTP status
  std::string address_;
  ConnectionLimit connections_;  ///< used by the server thread
  std::unique_ptr<MHD_Daemon, void (*)(MHD_Daemon*)> daemon_;
};

}  // namespace stillpoint::bench
