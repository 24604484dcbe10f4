// SPDX-License-Identifier: BSD-3-Clause
#include "bench/serve/event_streams.h"

#include <microhttpd.h>

#include <algorithm>

namespace stillpoint::bench {

void EventStreams::publish(const std::string& message) {
  const std::scoped_lock lock(mutex_);
  text_ = "data: " + message + "\n\n";
  ++version_;
  for (Stream& stream : streams_) resume(stream);
}

bool EventStreams::has_message() const {
  const std::scoped_lock lock(mutex_);
  return version_ > 0;
}

MHD_Response* EventStreams::open(MHD_Connection* connection) {
  constexpr std::size_t kBlockBytes = 4096;
  const std::scoped_lock lock(mutex_);
  const auto is_open = [](const Stream& stream) { return !stream.is_ended; };
  if (static_cast<std::size_t>(std::ranges::count_if(streams_, is_open)) >= kMaxStreams) {
    Stream& oldest = *std::ranges::find_if(streams_, is_open);
    oldest.is_ended = true;
    resume(oldest);
  }
  Stream& stream = streams_.emplace_back(Stream{.owner = this, .connection = connection});
  MHD_Response* response =
      MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kBlockBytes, read, &stream, close);
  if (response == nullptr) streams_.pop_back();
  return response;
}

void EventStreams::end_all() {
  const std::scoped_lock lock(mutex_);
  is_ended_ = true;
  for (Stream& stream : streams_) resume(stream);
}

/// Callback of libmicrohttpd that fills a buffer. It suspends the connection while the mutex is held, so that
/// no message is missed in between.
std::int64_t EventStreams::read(void* stream, std::uint64_t /*position*/, char* buffer, std::size_t size) {
  Stream& self = *static_cast<Stream*>(stream);
  EventStreams& owner = *self.owner;
  const std::scoped_lock lock(owner.mutex_);
  if (self.is_ended || owner.is_ended_) return MHD_CONTENT_READER_END_OF_STREAM;
  if (self.sent == self.text.size()) {
    if (self.version == owner.version_) {
      self.is_suspended = true;
      MHD_suspend_connection(self.connection);
      return 0;
    }
    self.version = owner.version_;
    self.text = owner.text_;
    self.sent = 0;
  }
  const std::size_t count = std::min(size, self.text.size() - self.sent);
  self.text.copy(buffer, count, self.sent);
  self.sent += count;
  return static_cast<std::int64_t>(count);
}

/// Callback of libmicrohttpd for a response that is no longer used.
void EventStreams::close(void* stream) {
  EventStreams& owner = *static_cast<Stream*>(stream)->owner;
  const std::scoped_lock lock(owner.mutex_);
  owner.streams_.remove_if([&](const Stream& one) { return &one == stream; });
}

void EventStreams::resume(Stream& stream) {
  if (!stream.is_suspended) return;
  stream.is_suspended = false;
  MHD_resume_connection(stream.connection);
}

}  // namespace stillpoint::bench
