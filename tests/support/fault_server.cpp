// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/fault_server.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace stillpoint {
namespace {

constexpr std::size_t kBlockBytes = 1U << 16U;
constexpr std::size_t kSlowBlockBytes = 1000;
constexpr int kPollMs = 20;

/// @return false if the peer has closed the connection
bool send_all(int connection, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t sent = send(connection, bytes, count, MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes += sent;
    count -= static_cast<std::size_t>(sent);
  }
  return true;
}

std::string receive_head(int connection) {
  std::string text;
  std::array<char, 1024> block{};
  while (text.find("\r\n\r\n") == std::string::npos) {
    const ssize_t count = recv(connection, block.data(), block.size(), 0);
    if (count <= 0) return "";
    text.append(block.data(), static_cast<std::size_t>(count));
  }
  return text;
}

ServedRequest parse_request(const std::string& head) {
  std::istringstream lines(head);
  ServedRequest request;
  std::string method;
  lines >> method >> request.path;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line) && line.size() > 1) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    std::string name = line.substr(0, colon);
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
    const std::size_t begin = line.find_first_not_of(' ', colon + 1);
    request.headers[name] = begin == std::string::npos ? "" : line.substr(begin, line.size() - begin - 1);
  }
  return request;
}

std::string response_head(const ServedResponse& response) {
  const std::uint64_t real = response.body.size() + response.zeros;
  const std::uint64_t length =
      response.declared_length < 0 ? real : static_cast<std::uint64_t>(response.declared_length);
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + " x\r\nConnection: close\r\n";
  for (const std::string& header : response.headers) head += header + "\r\n";
  return head + "Content-Length: " + std::to_string(length) + "\r\n\r\n";
}

void send_body(int connection, const ServedResponse& response, const std::atomic<bool>& stopped) {
  const std::string zeros(kBlockBytes, '\0');
  const std::size_t block = response.pause_ms > 0 ? kSlowBlockBytes : kBlockBytes;
  const std::uint64_t end = std::min(response.cut_after, response.body.size() + response.zeros);
  for (std::uint64_t sent = 0; sent < end && !stopped;) {
    const bool in_body = sent < response.body.size();
    const std::uint64_t available = in_body ? response.body.size() - sent : kBlockBytes;
    const auto count = static_cast<std::size_t>(std::min({available, std::uint64_t{block}, end - sent}));
    if (response.pause_ms > 0) poll(nullptr, 0, response.pause_ms);
    if (!send_all(connection, in_body ? response.body.data() + sent : zeros.data(), count)) return;
    sent += count;
  }
}

}  // namespace

std::uint64_t ServedRequest::first_byte() const {
  const std::string range = header("range");
  return range.starts_with("bytes=") ? std::stoull(range.substr(6)) : 0;
}

std::string ServedRequest::header(const std::string& name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? "" : found->second;
}

ServedResponse file_response(const ServedRequest& request, const std::string& content,
                             const std::string& etag) {
  const std::string condition = request.header("if-range");
  const std::uint64_t first = request.first_byte();
  if (first == 0 || (!condition.empty() && condition != etag))
    return {.headers = {"ETag: " + etag}, .body = content};
  if (first >= content.size())
    return {
        .status = 416, .headers = {"Content-Range: bytes */" + std::to_string(content.size())}, .body = ""};
  return {.status = 206,
          .headers = {"ETag: " + etag, "Content-Range: bytes " + std::to_string(first) + "-" +
                                           std::to_string(content.size() - 1) + "/" +
                                           std::to_string(content.size())},
          .body = content.substr(first)};
}

FaultServer::FaultServer(Handler handler, int port) : handler_(std::move(handler)) {
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int reuse = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &reuse, sizeof reuse);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (bind(socket_, generic, sizeof address) != 0 || listen(socket_, 32) != 0)
    throw std::runtime_error("the test server cannot listen");
  socklen_t size = sizeof address;
  getsockname(socket_, generic, &size);
  port_ = ntohs(address.sin_port);
  acceptor_ = std::thread([this] { accept_connections(); });
}

FaultServer::~FaultServer() {
  stopped_ = true;
  acceptor_.join();
  for (std::thread& connection : connections_) connection.join();
  close(socket_);
}

std::string FaultServer::url(const std::string& path) const {
  return "http://127.0.0.1:" + std::to_string(port_) + path;
}

void FaultServer::accept_connections() {
  while (!stopped_) {
    pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
    if (poll(&waiting, 1, kPollMs) <= 0) continue;
    const int connection = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
    if (connection < 0) continue;
    const std::lock_guard lock(mutex_);
    connections_.emplace_back([this, connection] { serve(connection); });
  }
}

void FaultServer::serve(int connection) {
  const std::string head = receive_head(connection);
  if (!head.empty()) {
    ServedRequest request = parse_request(head);
    request.number = ++requests_;
    const ServedResponse response = handler_(request);
    const std::string text = response_head(response);
    if (send_all(connection, text.data(), text.size())) send_body(connection, response, stopped_);
  }
  shutdown(connection, SHUT_RDWR);
  close(connection);
}

}  // namespace stillpoint
