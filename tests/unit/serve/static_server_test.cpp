// SPDX-License-Identifier: BSD-3-Clause
#include "bench/serve/static_server.h"

#include <array>
#include <chrono>
#include <memory>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "tests/support/expect_input_error.h"

namespace stillpoint::bench {
namespace {

/// A TCP connection to a local server; closed by the destructor.
class Client {
 public:
  explicit Client(std::uint16_t port, const char* address = "127.0.0.1")
      : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in server{};
    server.sin_family = AF_INET;
    server.sin_port = htons(port);
    inet_pton(AF_INET, address, &server.sin_addr);
    set_receive_timeout({5, 0});
    connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&server), sizeof server) == 0;
  }
  ~Client() { close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  [[nodiscard]] bool connected() const { return connected_; }

  /// Timeout of `received`.
  void set_receive_timeout(timeval timeout) const {
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
  }

  /// Sends until the server stops accepting data.
  void send_text(const std::string& text) const {
    std::size_t sent = 0;
    while (sent < text.size()) {
      const ssize_t count = send(socket_, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
      if (count <= 0) return;
      sent += static_cast<std::size_t>(count);
    }
  }

  /// Receives until the text contains `end`, or the server closes the connection.
  std::string received_until(const std::string& end) const {
    std::string text;
    char byte = 0;
    while (!text.ends_with(end) && recv(socket_, &byte, 1, 0) > 0) text += byte;
    return text;
  }

  /// Receives until the server closes the connection; empty if the connection was reset.
  [[nodiscard]] std::string received() const {
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t count = 0; (count = recv(socket_, block.data(), block.size(), 0)) > 0;)
      text.append(block.data(), static_cast<std::size_t>(count));
    return text;
  }

 private:
  int socket_;
  bool connected_ = false;
};

const std::vector<OutputFile> kFiles = {
    {"index.html", "<p>index</p>"}, {"commits/a.html", "<p>a</p>"}, {"r.json", "{}"}};

StaticServer make_server() { return StaticServer(kFiles, {.port = 0}); }

std::string reply_of(const StaticServer& server, const std::string& request) {
  const Client client(server.port());
  client.send_text(request);
  return client.received();
}

std::string request_of(const std::string& method, const std::string& path,
                       const std::string& host = "localhost") {
  return method + " " + path + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n";
}

/// "200" of "HTTP/1.1 200 OK..."; empty for an empty response.
std::string status_of(const std::string& response) {
  return response.size() < 12 ? "" : response.substr(9, 3);
}

TEST(StaticServer, ServesItsFiles) {
  const StaticServer server = make_server();
  const std::string index = reply_of(server, request_of("GET", "/"));
  EXPECT_EQ(status_of(index), "200");
  EXPECT_TRUE(index.ends_with("\r\n\r\n<p>index</p>"));
  EXPECT_NE(index.find("text/html; charset=utf-8"), std::string::npos);
  EXPECT_TRUE(reply_of(server, request_of("GET", "/commits/a.html?x=1")).ends_with("<p>a</p>"));
  EXPECT_NE(reply_of(server, request_of("GET", "/r.json")).find("application/json"), std::string::npos);
}

TEST(StaticServer, AnswersHeadWithoutBody) {
  const std::string response = reply_of(make_server(), request_of("HEAD", "/index.html"));
  EXPECT_EQ(status_of(response), "200");
  EXPECT_NE(response.find("Content-Length: 12"), std::string::npos);
  EXPECT_TRUE(response.ends_with("\r\n\r\n"));
}

TEST(StaticServer, RejectsOtherMethods) {
  const StaticServer server = make_server();
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "get"})
    EXPECT_EQ(status_of(reply_of(server, request_of(method, "/"))), "405") << method;
  EXPECT_NE(reply_of(server, request_of("POST", "/")).find("Allow: GET, HEAD"), std::string::npos);
}

TEST(StaticServer, DoesNotAccessTheFileSystem) {
  const StaticServer server = make_server();
  for (const char* path : {"/../etc/passwd", "/commits/../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
                           "/..%2f..%2fetc%2fpasswd", "/%252e%252e/etc/passwd", "/%c0%ae%c0%ae/etc/passwd",
                           "//etc/passwd", "/commits/", "/commits", "\\..\\etc"}) {
    const std::string status = status_of(reply_of(server, request_of("GET", path)));
    EXPECT_TRUE(status == "404" || status == "400") << path << " " << status;
  }
}

TEST(StaticServer, RejectsPathsWithControlCharacters) {
  const StaticServer server = make_server();
  for (const char* path : {"/%00", "/index.html%00", "/%00index.html", "/%0a", "/%7F", "/r.json%00.html"})
    EXPECT_EQ(status_of(reply_of(server, request_of("GET", path))), "400") << path;
}

TEST(StaticServer, RejectsLongRequests) {
  const StaticServer server = make_server();
  const std::string long_path = reply_of(server, request_of("GET", "/" + std::string(100'000, 'a')));
  EXPECT_EQ(status_of(long_path), "414");
  std::string many_headers = "GET / HTTP/1.1\r\nHost: localhost\r\n";
  for (int i = 0; i < 5000; ++i) many_headers += "X-Header-" + std::to_string(i) + ": some text\r\n";
  const std::string status = status_of(reply_of(server, many_headers + "\r\n"));
  EXPECT_TRUE(status == "431" || status.empty()) << status;  // empty: connection reset during sending
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/"))), "200");
}

TEST(StaticServer, DoesNotReadBodies) {
  const StaticServer server = make_server();
  const Client client(server.port());
  client.send_text("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000000000\r\n\r\n");
  EXPECT_EQ(status_of(client.received()), "405");  // before any of the body was received
}

TEST(StaticServer, ListensOnItsAddressOnly) {
  const StaticServer server = make_server();
  EXPECT_TRUE(Client(server.port()).connected());
  EXPECT_FALSE(Client(server.port(), "127.0.0.2").connected());  // succeeds on a wildcard address
}

TEST(StaticServer, RejectsRequestsWithAForeignHostHeader) {
  const StaticServer server = make_server();
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/", "127.0.0.1:8035"))), "200");
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/", "localhost:1"))), "200");  // a tunnel
  for (const char* host :
       {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80", "127.0.0.1:8137.evil.com",
        "localhost:", "localhost:80:80", "localhost:123456", "localhost: 80", "user@localhost", ":80"})
    EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/", host))), "403") << host;
}

TEST(StaticServer, AnswersWhileManyConnectionsSendIncompleteRequests) {
  constexpr int kAttackers = 300;
  const StaticServer server = make_server();
  std::vector<std::unique_ptr<Client>> slow;
  for (int i = 0; i < kAttackers; ++i) {
    slow.push_back(std::make_unique<Client>(server.port()));
    slow.back()->send_text("GET / HTTP/1.1\r\nHost: local");
  }
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/"))), "200");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
  EXPECT_EQ(slow.front()->received(), "");  // closed by the server, before its timeout
}

TEST(StaticServer, ClosesTheOldestConnectionForANewOne) {
  constexpr int kConnections = 32;
  const StaticServer server = make_server();
  std::vector<std::unique_ptr<Client>> idle;
  for (int i = 0; i < kConnections; ++i) idle.push_back(std::make_unique<Client>(server.port()));
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/"))), "200");
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(idle[0]->received(), "");
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));  // before its timeout
  idle[1]->send_text(request_of("GET", "/r.json"));
  EXPECT_EQ(status_of(idle[1]->received()), "200");
}

TEST(StaticServer, ReplacesItsFiles) {
  StaticServer server = make_server();
  server.replace({{"new.html", "<p>new</p>"}});
  EXPECT_TRUE(reply_of(server, request_of("GET", "/new.html")).ends_with("<p>new</p>"));
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/r.json"))), "404");
}

TEST(StaticServer, SendsEachMessageToAllStreamsAndTheNewestToNewOnes) {
  StaticServer server = make_server();
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/events"))), "404");  // before the first message
  server.publish("{\"runs\":1}");
  const Client first(server.port());
  first.send_text(request_of("GET", "/events"));
  EXPECT_NE(first.received_until("\n\r\n").find("text/event-stream"), std::string::npos);
  EXPECT_TRUE(first.received_until("\n\n").ends_with("data: {\"runs\":1}\n\n"));
  server.publish("{\"runs\":2}");
  EXPECT_TRUE(first.received_until("\n\n").ends_with("data: {\"runs\":2}\n\n"));
  const Client second(server.port());
  second.send_text(request_of("GET", "/events"));
  second.received_until("\n\r\n");
  EXPECT_TRUE(second.received_until("\n\n").ends_with("data: {\"runs\":2}\n\n"));
  EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/events", "evil.example"))), "403");
}

TEST(StaticServer, StreamsOutliveManyConnections) {
  StaticServer server = make_server();
  server.publish("1");
  const Client stream(server.port());
  stream.send_text(request_of("GET", "/events"));
  stream.received_until("data: 1\n\n");
  for (int i = 0; i < 100; ++i) EXPECT_EQ(status_of(reply_of(server, request_of("GET", "/"))), "200");
  server.publish("2");
  EXPECT_TRUE(stream.received_until("data: 2\n\n").ends_with("data: 2\n\n"));
}

TEST(StaticServer, EndsTheOldestStreamForANewOne) {
  StaticServer server = make_server();
  server.publish("1");
  std::vector<std::unique_ptr<Client>> streams;
  for (std::size_t i = 0; i <= EventStreams::kMaxStreams; ++i) {
    streams.push_back(std::make_unique<Client>(server.port()));
    streams.back()->send_text(request_of("GET", "/events"));
    EXPECT_TRUE(streams.back()->received_until("data: 1\n\n").ends_with("data: 1\n\n")) << i;
  }
  EXPECT_TRUE(streams.front()->received().ends_with("0\r\n\r\n"));  // the last chunk
  server.publish("2");
  EXPECT_TRUE(streams[1]->received_until("data: 2\n\n").ends_with("data: 2\n\n"));
}

TEST(StaticServer, EndsWhileStreamsAreOpen) {
  auto server = std::make_unique<StaticServer>(kFiles, ServerOptions{.port = 0});
  server->publish("1");
  const Client stream(server->port());
  stream.send_text(request_of("GET", "/events"));
  stream.received_until("data: 1\n\n");
  const auto start = std::chrono::steady_clock::now();
  server.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
}

TEST(StaticServer, RejectsInvalidAddressesAndPortsInUse) {
  expect_input_error([] { const StaticServer server(kFiles, {.address = "here", .port = 0}); },
                     {"--address", "here"});
  expect_input_error([] { const StaticServer server(kFiles, {.port = 70000}); }, {"--port"});
  const StaticServer first = make_server();
  expect_input_error([&] { const StaticServer second(kFiles, {.port = first.port()}); },
                     {"--port", "in use"});
}

}  // namespace
}  // namespace stillpoint::bench
