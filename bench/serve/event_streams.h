// SPDX-License-Identifier: BSD-3-Clause
/// Server-sent events (https://html.spec.whatwg.org/#server-sent-events): responses that stay open and
/// receive messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <string>

struct MHD_Connection;
struct MHD_Response;

namespace stillpoint::bench {

/// Open streams of one server. Each sends the newest message, and the next one after each `publish`; messages
/// that a slow client did not receive in time are skipped. Thread-safe. Streams without a new message are
/// suspended, so that they cost no time.
class EventStreams {
 public:
  static constexpr std::size_t kMaxStreams = 16;

  /// @param message one line
  void publish(const std::string& message);

  /// Whether there is a message.
  [[nodiscard]] bool has_message() const;

  /// A response for a connection of a daemon with MHD_ALLOW_SUSPEND_RESUME; null without memory. Ends the
  /// oldest stream if there are too many: of a suspended one it is unknown whether its client still exists.
  [[nodiscard]] MHD_Response* open(MHD_Connection* connection);

  /// Ends all streams, and those that are opened later; required before the daemon is stopped.
  void end_all();

 private:
  struct Stream {
    EventStreams* owner = nullptr;
    MHD_Connection* connection = nullptr;
    std::uint64_t version = 0;  ///< of `text`
    std::string text{};         ///< being sent
    std::size_t sent = 0;       ///< bytes of `text`
    bool is_suspended = false;
    bool is_ended = false;
  };

  static std::int64_t read(void* stream, std::uint64_t position, char* buffer, std::size_t size);
  static void close(void* stream);
  static void resume(Stream& stream);

  mutable std::mutex mutex_;  ///< guards all members
  std::list<Stream> streams_;
  std::string text_;           ///< the newest message as an event
  std::uint64_t version_ = 0;  ///< number of messages
  bool is_ended_ = false;
};

}  // namespace stillpoint::bench
