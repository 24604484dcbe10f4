// SPDX-License-Identifier: BSD-3-Clause
#include "bench/serve/static_server.h"

#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <microhttpd.h>
#include <netinet/in.h>

#include "core/base/error.h"

namespace stillpoint {
namespace {

constexpr std::size_t kConnectionBytes = 32 * 1024;
constexpr unsigned kConnections = 32;
constexpr unsigned kTimeoutS = 10;
constexpr int kLargestPort = 65535;

std::string type_of(const std::string& path) {
  if (path.ends_with(".html")) return "text/html; charset=utf-8";
  if (path.ends_with(".json")) return "application/json";
  return "text/plain; charset=utf-8";
}

/// Without the port.
std::string host_name(const std::string& host) { return host.substr(0, host.rfind(':')); }

std::string host_of(MHD_Connection* connection) {
  const char* host = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
  return host == nullptr ? "" : host;
}

/// Called by the library for each request, before any of its body is read: what is queued now ends the
/// request.
MHD_Result on_request(void* server, MHD_Connection* connection, const char* path, const char* method,
                      const char* /*version*/, const char* /*upload*/, std::size_t* /*upload_bytes*/,
                      void** /*request*/) {
  const StaticServer::Answer answer =
      static_cast<const StaticServer*>(server)->answer(method, path, host_of(connection));
  // The library asks for a mutable pointer and does not write through it.
  MHD_Response* response = MHD_create_response_from_buffer(
      answer.text->size(), const_cast<char*>(answer.text->data()), MHD_RESPMEM_PERSISTENT);
  if (response == nullptr) return MHD_NO;
  const auto header = [&](const char* name, const char* value) {
    MHD_add_response_header(response, name, value);
  };
  header(MHD_HTTP_HEADER_CONTENT_TYPE, answer.type.c_str());
  header("X-Content-Type-Options", "nosniff");
  header("Content-Security-Policy", "frame-ancestors 'none'");
  header(MHD_HTTP_HEADER_CACHE_CONTROL, "no-cache");
  if (answer.status == MHD_HTTP_METHOD_NOT_ALLOWED) header(MHD_HTTP_HEADER_ALLOW, "GET, HEAD");
  const MHD_Result result = MHD_queue_response(connection, answer.status, response);
  MHD_destroy_response(response);
  return result;
}

sockaddr_in address_of(const ServerOptions& options) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (inet_pton(AF_INET, options.address.c_str(), &address.sin_addr) != 1)
    throw InputError("--address", "\"" + options.address + "\" is no IPv4 address; use 127.0.0.1");
  if (options.port < 0 || options.port > kLargestPort) throw InputError("--port", "must be from 0 to 65535");
  address.sin_port = htons(static_cast<std::uint16_t>(options.port));
  return address;
}

}  // namespace

StaticServer::StaticServer(const std::vector<OutputFile>& files, const ServerOptions& options)
    : refusals_({{MHD_HTTP_METHOD_NOT_ALLOWED, "only GET and HEAD are answered\n"},
                 {MHD_HTTP_FORBIDDEN, "the request names another host\n"},
                 {MHD_HTTP_NOT_FOUND, "there is no such page\n"}}),
      address_(options.address),
      daemon_(nullptr, MHD_stop_daemon) {
  for (const OutputFile& file : files) texts_["/" + file.name] = file.text;
  const sockaddr_in address = address_of(options);
  daemon_.reset(MHD_start_daemon(
      MHD_USE_AUTO_INTERNAL_THREAD, 0, nullptr, nullptr, on_request, this, MHD_OPTION_SOCK_ADDR, &address,
      MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionBytes, MHD_OPTION_CONNECTION_LIMIT, kConnections,
      MHD_OPTION_CONNECTION_TIMEOUT, kTimeoutS, MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_END));
  if (daemon_ == nullptr) {
    throw InputError("--port", std::to_string(options.port) + " of " + options.address +
                                   " cannot be taken: " + std::strerror(errno) +
                                   "; give another, or 0 for any");
  }
}

std::uint16_t StaticServer::port() const {
  return MHD_get_daemon_info(daemon_.get(), MHD_DAEMON_INFO_BIND_PORT)->port;
}

StaticServer::Answer StaticServer::answer(const std::string& method, const std::string& path,
                                          const std::string& host) const {
  const auto refusal = [&](unsigned status) {
    return Answer{status, &refusals_.at(status), "text/plain; charset=utf-8"};
  };
  if (method != MHD_HTTP_METHOD_GET && method != MHD_HTTP_METHOD_HEAD)
    return refusal(MHD_HTTP_METHOD_NOT_ALLOWED);
  const std::string name = host_name(host);
  const bool is_loopback = address_.starts_with("127.");
  if (is_loopback && name != "localhost" && name != address_) return refusal(MHD_HTTP_FORBIDDEN);
  const auto found = texts_.find(path.ends_with('/') ? path + "index.html" : path);
  if (found == texts_.end()) return refusal(MHD_HTTP_NOT_FOUND);
  return {MHD_HTTP_OK, &found->second, type_of(found->first)};
}

}  // namespace stillpoint
