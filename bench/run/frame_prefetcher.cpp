// SPDX-License-Identifier: BSD-3-Clause
#include "bench/run/frame_prefetcher.h"

#include <utility>

#include "core/base/error.h"
#include "core/base/thread_name.h"

namespace stillpoint::bench {

FramePrefetcher::FramePrefetcher(Load load, std::size_t count, ReadAhead ahead)
    : load_(std::move(load)), count_(count), ahead_(ahead) {
  if (ahead_.frames == 0) return;
  for (std::size_t i = 0; i < ahead_.threads; ++i) threads_.emplace_back([this] { decode_all(); });
}

FramePrefetcher::~FramePrefetcher() {
  const std::scoped_lock lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

Frame FramePrefetcher::take(std::size_t index) {
  STILLPOINT_CHECK(index >= next_ && index < count_);
  next_ = index + 1;
  Slot slot = ahead_.frames > 0 ? wait_for(index) : decode(index);
  decoded_.push_back(slot.decoded);
  if (slot.error) std::rethrow_exception(slot.error);
  return std::move(slot.frame);
}

FramePrefetcher::Slot FramePrefetcher::wait_for(std::size_t index) {
  std::unique_lock lock(mutex_);
  Slot slot;
  do {
    changed_.wait(lock, [this] { return slots_.contains(released_); });
    slot = std::move(slots_.extract(released_).mapped());
    ++released_;
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

std::optional<std::size_t> FramePrefetcher::claim() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock,
                [this] { return stopped_ || claimed_ == count_ || claimed_ < released_ + ahead_.frames; });
  if (stopped_ || claimed_ == count_) return std::nullopt;
  return claimed_++;
}

void FramePrefetcher::decode_all() {
  name_this_thread("decoding");
  while (const std::optional<std::size_t> index = claim()) {
    Slot slot = decode(*index);
    const std::scoped_lock lock(mutex_);
    slots_.emplace(*index, std::move(slot));
    changed_.notify_all();
  }
}

}  // namespace stillpoint::bench
