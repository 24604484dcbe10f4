// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process/process_pool.h"

#include <algorithm>

#include <poll.h>

namespace stillpoint::bench {

void ProcessPool::start(std::size_t tag, const ProcessSpec& spec) {
  children_.push_back({tag, std::make_unique<ChildProcess>(spec)});
}

void ProcessPool::forward_stop() {
  if (stop_forwarded_ || !stop_requested_ || !stop_requested_()) return;
  stop_forwarded_ = true;
  for (const Entry& entry : children_) entry.child->terminate();
}

void ProcessPool::wait_for_messages() const {
  std::vector<pollfd> descriptors;
  int poll_timeout_ms = children_.front().child->poll_timeout_ms();
  for (const Entry& entry : children_) {
    descriptors.push_back({.fd = entry.child->message_pipe(), .events = POLLIN, .revents = 0});
    poll_timeout_ms = std::min(poll_timeout_ms, entry.child->poll_timeout_ms());
  }
  poll(descriptors.data(), descriptors.size(), poll_timeout_ms);
}

std::optional<std::pair<std::size_t, ProcessResult>> ProcessPool::wait_next(
    const std::function<bool()>& wake) {
  while (!children_.empty()) {
    forward_stop();
    for (auto entry = children_.begin(); entry != children_.end(); ++entry) {
      if (entry->child->poll_once()) continue;
      const std::size_t tag = entry->tag;
      const ProcessResult result = entry->child->wait();
      children_.erase(entry);
      return std::pair{tag, result};
    }
    if (wake && wake()) return std::nullopt;
    wait_for_messages();
  }
  return std::nullopt;
}

}  // namespace stillpoint::bench
