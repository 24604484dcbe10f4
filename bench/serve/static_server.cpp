// SPDX-License-Identifier: BSD-3-Clause
#include "bench/serve/static_server.h"

#include <arpa/inet.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/base/error.h"

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

namespace {

constexpr std::size_t kConnectionBytes = std::size_t{32} * 1024;
constexpr unsigned kConnections = 32;
// Includes those that were shut down and not yet closed.
constexpr unsigned kAccepted = 2 * kConnections + unsigned{EventStreams::kMaxStreams};
constexpr unsigned kTimeoutS = 5;
constexpr int kLargestPort = 65535;
constexpr std::size_t kPortDigits = 5;
constexpr char kInvalidByte = '\x01';

std::string content_type(const std::string& path) {
  if (path.ends_with(".html")) return "text/html; charset=utf-8";
  if (path.ends_with(".svg")) return "image/svg+xml";
  if (path.ends_with(".json")) return "application/json";
  return "text/plain; charset=utf-8";
}

/// The host without its port, which may be that of a tunnel; empty if the port is not a number.
std::string host_name(const std::string& host) {
  const std::size_t colon = host.find(':');
  if (colon == std::string::npos) return host;
  const std::string port = host.substr(colon + 1);
  const bool is_port = !port.empty() && port.size() <= kPortDigits &&
                       port.find_first_not_of("0123456789") == std::string::npos;
  return is_port ? host.substr(0, colon) : "";
}

bool is_control(char letter) { return static_cast<unsigned char>(letter) < ' ' || letter == '\x7f'; }

/// Callback of libmicrohttpd that decodes "%41". A decoded zero byte would end the path; it is replaced by
/// another control character, which `respond` rejects.
std::size_t unescape(void* /*unused*/, MHD_Connection* /*connection*/, char* text) {
  const std::size_t length = MHD_http_unescape(text);
  std::replace(text, text + length, '\0', kInvalidByte);
  return length;
}

int socket_of(MHD_Connection* connection) {
  return MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
}

/// Why a request is not answered by a file.
const char* error_text(unsigned status) {
  switch (status) {
    case MHD_HTTP_BAD_REQUEST:
      return "the path contains control characters\n";
    case MHD_HTTP_METHOD_NOT_ALLOWED:
      return "only GET and HEAD are supported\n";
    case MHD_HTTP_FORBIDDEN:
      return "the Host header does not match this server\n";
    default:
      return "page not found\n";
  }
}

/// Callback of libmicrohttpd for connections that begin or end.
void on_connection(void* connections, MHD_Connection* connection, void** /*context*/,
                   MHD_ConnectionNotificationCode code) {
  auto& limit = *static_cast<ConnectionLimit*>(connections);
  if (code == MHD_CONNECTION_NOTIFY_STARTED) {
    limit.opened(socket_of(connection), ConnectionLimit::Clock::now());
  } else {
    limit.closed(socket_of(connection));
  }
}

std::string host_of(MHD_Connection* connection) {
  const char* host = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, MHD_HTTP_HEADER_HOST);
  return host == nullptr ? "" : host;
}

/// A response that keeps its text as long as it is used; null without memory.
MHD_Response* response_of(std::shared_ptr<const std::string> text) {
  auto owner = std::make_unique<std::shared_ptr<const std::string>>(std::move(text));
  const std::string& bytes = **owner;
  const auto release = [](void* held) { delete static_cast<std::shared_ptr<const std::string>*>(held); };
  // libmicrohttpd takes a non-const pointer, but does not write to the buffer.
  MHD_Response* response = MHD_create_response_from_buffer_with_free_callback_cls(
      bytes.size(), const_cast<char*>(bytes.data()), release, owner.get());
  if (response != nullptr) static_cast<void>(owner.release());
  return response;
}

sockaddr_in address_of(const ServerOptions& options) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (inet_pton(AF_INET, options.address.c_str(), &address.sin_addr) != 1)
    throw InputError("--address", "\"" + options.address + "\" is not an IPv4 address, e.g. 127.0.0.1");
  if (options.port < 0 || options.port > kLargestPort) throw InputError("--port", "must be from 0 to 65535");
  address.sin_port = htons(static_cast<std::uint16_t>(options.port));
  return address;
}

/// Why an address cannot be used. libmicrohttpd does not keep the error: it is provoked again.
std::string listen_error(const sockaddr_in& address) {
  const int file = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (file < 0) return std::strerror(errno);
  const bool is_free = bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  std::string error = is_free ? "the server cannot be started" : std::strerror(errno);
  close(file);
  return error;
}

}  // namespace

struct StaticServer::Requests {
  /// Callback of libmicrohttpd for each request. Called first with the headers only: the response queued then
  /// completes the request, so no body is read.
  // NOLINTNEXTLINE(readability-function-size): libmicrohttpd prescribes the parameters
  static MHD_Result answer(void* server, MHD_Connection* connection, const char* path, const char* method,
                           const char* /*version*/, const char* /*upload*/, std::size_t* /*upload_bytes*/,
                           void** /*request*/) {
    auto& self = *static_cast<StaticServer*>(server);
    const Response reply = self.respond(method, path, host_of(connection));
    const bool is_stream = reply.text == nullptr;
    MHD_Response* response = is_stream ? self.events_.open(connection) : response_of(reply.text);
    if (response == nullptr) return MHD_NO;
    if (is_stream) self.connections_.closed(socket_of(connection));  // has a limit of its own
    const auto header = [&](const char* name, const char* value) {
      MHD_add_response_header(response, name, value);
    };
    header(MHD_HTTP_HEADER_CONTENT_TYPE, reply.type.c_str());
    header("X-Content-Type-Options", "nosniff");
    header("Content-Security-Policy", "frame-ancestors 'none'");
    header(MHD_HTTP_HEADER_CACHE_CONTROL, "no-cache");
    if (reply.status == MHD_HTTP_METHOD_NOT_ALLOWED) header(MHD_HTTP_HEADER_ALLOW, "GET, HEAD");
    const MHD_Result result = MHD_queue_response(connection, reply.status, response);
    MHD_destroy_response(response);
    return result;
  }
};

StaticServer::StaticServer(const std::vector<OutputFile>& files, const ServerOptions& options)
    : address_(options.address), connections_(kConnections), daemon_(nullptr, MHD_stop_daemon) {
  replace(files);
  const sockaddr_in address = address_of(options);
  daemon_.reset(MHD_start_daemon(
      MHD_USE_AUTO_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, Requests::answer, this,
      MHD_OPTION_SOCK_ADDR, &address, MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionBytes,
      MHD_OPTION_CONNECTION_LIMIT, kAccepted, MHD_OPTION_NOTIFY_CONNECTION, on_connection, &connections_,
      MHD_OPTION_UNESCAPE_CALLBACK, unescape, nullptr, MHD_OPTION_CONNECTION_TIMEOUT, kTimeoutS,
      MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_END));
  if (daemon_ == nullptr) {
    throw InputError("--port", "cannot listen on " + options.address + ":" + std::to_string(options.port) +
                                   ": " + listen_error(address) +
                                   "; use another port, or 0 for any free port");
  }
}

StaticServer::~StaticServer() { events_.end_all(); }

std::uint16_t StaticServer::port() const {
  return MHD_get_daemon_info(daemon_.get(), MHD_DAEMON_INFO_BIND_PORT)->port;
}

void StaticServer::replace(const std::vector<OutputFile>& files) {
  Texts texts;
  for (const OutputFile& file : files)
    texts["/" + file.name] = std::make_shared<const std::string>(file.text);
  const std::scoped_lock lock(mutex_);
  texts_.swap(texts);
}

StaticServer::Response StaticServer::respond(const std::string& method, const std::string& path,
                                             const std::string& host) const {
  const auto error = [](unsigned status) {
    return Response{status, std::make_shared<const std::string>(error_text(status)),
                    "text/plain; charset=utf-8"};
  };
  if (method != MHD_HTTP_METHOD_GET && method != MHD_HTTP_METHOD_HEAD)
    return error(MHD_HTTP_METHOD_NOT_ALLOWED);
  const std::string name = host_name(host);
  const bool is_loopback = address_.starts_with("127.");
  if (is_loopback && name != "localhost" && name != address_) return error(MHD_HTTP_FORBIDDEN);
  if (std::ranges::any_of(path, is_control)) return error(MHD_HTTP_BAD_REQUEST);
  if (path == kEvents && events_.has_message()) return {MHD_HTTP_OK, nullptr, "text/event-stream"};
  const std::scoped_lock lock(mutex_);
  const auto found = texts_.find(path.ends_with('/') ? path + "index.html" : path);
  if (found == texts_.end()) return error(MHD_HTTP_NOT_FOUND);
  return {MHD_HTTP_OK, found->second, content_type(found->first)};
}

}  // namespace stillpoint::bench
