// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/frame_prefetcher.h"

#include <utility>

#include "core/base/error.h"
#include "core/base/thread_name.h"

namespace stillpoint::bench {

FramePrefetcher::FramePrefetcher(Load load, std::size_t count, std::size_t ahead)
    : load_(std::move(load)), count_(count), ahead_(ahead) {
  if (ahead_ > 0) thread_ = std::jthread([this] { decode_all(); });
}

FramePrefetcher::~FramePrefetcher() {
  const std::scoped_lock lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

Frame FramePrefetcher::take(std::size_t index) {
  STILLPOINT_CHECK(index >= next_ && index < count_);
  next_ = index + 1;
  Slot slot = ahead_ > 0 ? wait_for(index) : decode(index);
  decoded_.push_back(slot.decoded);
  if (slot.error) std::rethrow_exception(slot.error);
  return std::move(slot.frame);
}

FramePrefetcher::Slot FramePrefetcher::wait_for(std::size_t index) {
  std::unique_lock lock(mutex_);
  Slot slot;
  do {
    changed_.wait(lock, [this] { return !slots_.empty(); });
    slot = std::move(slots_.front());
    slots_.pop_front();
    changed_.notify_all();
  } while (slot.decoded.index < index);
  return slot;
}

FramePrefetcher::Slot FramePrefetcher::decode(std::size_t index) const {
  Slot slot{.decoded = {.index = index, .start = std::chrono::steady_clock::now(), .elapsed = {}},
            .frame = {},
            .error = nullptr};
  try {
    slot.frame = load_(index);
  } catch (...) {
    slot.error = std::current_exception();
  }
  slot.decoded.elapsed = std::chrono::steady_clock::now() - slot.decoded.start;
  return slot;
}

void FramePrefetcher::decode_all() {
  name_this_thread("decoding");
  for (std::size_t index = 0; index < count_; ++index) {
    Slot slot = decode(index);
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stopped_ || slots_.size() < ahead_; });
    if (stopped_) return;
    slots_.push_back(std::move(slot));
    changed_.notify_all();
  }
}

}  // namespace stillpoint::bench
