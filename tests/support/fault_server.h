// SPDX-License-Identifier: BSD-3-Clause
/// HTTP server on 127.0.0.1 whose responses can have any defect.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace stillpoint {

struct ServedRequest {
  std::string path;                            ///< with the leading slash
  std::map<std::string, std::string> headers;  ///< names in lower case
  int number = 0;                              ///< counted from 1 over all requests of the server

  /// First byte of a `Range: bytes=N-`; 0 without one.
  [[nodiscard]] std::uint64_t first_byte() const;
  [[nodiscard]] std::string header(const std::string& name) const;
};

struct ServedResponse {
  int status = 200;
  std::vector<std::string> headers;      ///< complete lines, without Content-Length
  std::string body;                      ///< followed by `zeros`
  std::uint64_t zeros = 0;               ///< number of zero bytes after the body
  std::int64_t declared_length = -1;     ///< Content-Length; negative: the real one
  std::uint64_t cut_after = UINT64_MAX;  ///< body bytes before the connection is closed
  int pause_ms = 0;                      ///< before each block of 1 kB
};

/// The correct response for a file: 200, or 206 for a Range whose If-Range matches the ETag.
[[nodiscard]] ServedResponse file_response(const ServedRequest& request, const std::string& content,
                                           const std::string& etag);

class FaultServer {
 public:
  using Handler = std::function<ServedResponse(const ServedRequest&)>;

  /// @param port 0: any free one
  explicit FaultServer(Handler handler, int port = 0);
  ~FaultServer();
  FaultServer(const FaultServer&) = delete;
  FaultServer& operator=(const FaultServer&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// "http://127.0.0.1:PORT" and the path.
  [[nodiscard]] std::string url(const std::string& path) const;
  [[nodiscard]] int requests() const { return requests_; }

 private:
  void accept_connections();
  void serve(int connection);

  Handler handler_;
  int socket_ = -1;
  int port_ = 0;
  std::atomic<int> requests_ = 0;
  std::atomic<bool> stopped_ = false;
  std::mutex mutex_;  ///< of `connections_`
  std::vector<std::thread> connections_;
  std::thread acceptor_;
};

}  // namespace stillpoint
