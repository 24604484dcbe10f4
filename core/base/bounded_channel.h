// SPDX-License-Identifier: BSD-3-Clause
/// Bounded blocking queue between threads, which counts how long they wait for it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stillpoint {

struct WaitTime {
  std::int64_t ns = 0;
  std::int64_t waits = 0;  ///< calls that blocked; calls that could proceed at once are not counted
};

struct ChannelWaits {
  std::string channel;
  WaitTime for_items;  ///< consumers, channel empty
  WaitTime for_room;   ///< producers, channel full
};

/// First in, first out; any number of threads may push and pop.
template <class T>
class BoundedChannel {
 public:
  /// @param capacity at least 1
  explicit BoundedChannel(std::size_t capacity) : items_(capacity) {}

  /// Blocks while the channel is full. @return false if the channel is closed; the value is then discarded
  bool push(T value) {
    std::unique_lock lock(mutex_);
    wait(has_room_, lock, for_room_, [this] { return closed_ || count_ < items_.size(); });
    if (closed_) return false;
    append(std::move(value));
    return true;
  }

  /// Never blocks: drops the oldest item if the channel is full. @return the dropped item, if any
  std::optional<T> push_dropping_oldest(T value) {
    const std::scoped_lock lock(mutex_);
    std::optional<T> dropped;
    if (closed_) return dropped;
    if (count_ == items_.size()) dropped = take_front();
    append(std::move(value));
    return dropped;
  }

  /// Blocks while the channel is empty. @return nullopt once the channel is closed and empty
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    wait(has_items_, lock, for_items_, [this] { return closed_ || count_ > 0; });
    return take_front();
  }

  /// Blocks for at most `timeout`. @return nullopt if no item arrived in time
  std::optional<T> pop_for(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    has_items_.wait_for(lock, timeout, [this] { return closed_ || count_ > 0; });
    return take_front();
  }

  /// After this call nothing can be pushed; remaining items can still be popped. Idempotent.
  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    has_room_.notify_all();
    has_items_.notify_all();
  }

  /// Wait statistics of `push` and `pop` so far; `pop_for` is not counted.
  [[nodiscard]] ChannelWaits waits(std::string name) const {
    const std::scoped_lock lock(mutex_);
    return {.channel = std::move(name), .for_items = for_items_, .for_room = for_room_};
  }

 private:
  template <class Ready>
  static void wait(std::condition_variable& changed, std::unique_lock<std::mutex>& lock, WaitTime& time,
                   const Ready& ready) {
    if (ready()) return;
    const auto start = std::chrono::steady_clock::now();
    changed.wait(lock, ready);
    time.ns += std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count();
    ++time.waits;
  }

  void append(T value) {
    items_[(front_ + count_) % items_.size()] = std::move(value);
    ++count_;
    has_items_.notify_one();
  }

  std::optional<T> take_front() {
    if (count_ == 0) return std::nullopt;
    std::optional<T> item = std::exchange(items_[front_], std::nullopt);
    front_ = (front_ + 1) % items_.size();
    --count_;
    has_room_.notify_one();
    return item;
  }

  mutable std::mutex mutex_;
  std::condition_variable has_room_;
  std::condition_variable has_items_;
  // All guarded by mutex_.
  std::vector<std::optional<T>> items_;  ///< ring buffer, allocated once
  std::size_t front_ = 0;                ///< index of the oldest item
  std::size_t count_ = 0;                ///< number of items
  bool closed_ = false;
  WaitTime for_items_;
  WaitTime for_room_;
};

}  // namespace stillpoint
