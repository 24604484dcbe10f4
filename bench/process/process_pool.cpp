// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process/process_pool.h"

#include <algorithm>

#include <poll.h>

namespace stillpoint {

void ProcessPool::start(std::size_t tag, const ProcessSpec& spec) {
  children_.push_back({tag, std::make_unique<ChildProcess>(spec)});
}

void ProcessPool::pass_on_stop() {
  if (stop_passed_on_ || !stop_requested_ || !stop_requested_()) return;
  stop_passed_on_ = true;
  for (const Entry& entry : children_) entry.child->ask_to_end();
}

void ProcessPool::wait_for_messages() const {
  std::vector<pollfd> waited;
  int patience_ms = children_.front().child->patience_ms();
  for (const Entry& entry : children_) {
    waited.push_back({.fd = entry.child->message_pipe(), .events = POLLIN, .revents = 0});
    patience_ms = std::min(patience_ms, entry.child->patience_ms());
  }
  poll(waited.data(), waited.size(), patience_ms);
}

std::optional<std::pair<std::size_t, ProcessEnd>> ProcessPool::wait_next() {
  while (!children_.empty()) {
    pass_on_stop();
    for (auto entry = children_.begin(); entry != children_.end(); ++entry) {
      if (entry->child->attend()) continue;
      const std::size_t tag = entry->tag;
      const ProcessEnd end = entry->child->wait();
      children_.erase(entry);
      return std::pair{tag, end};
    }
    wait_for_messages();
  }
  return std::nullopt;
}

}  // namespace stillpoint
