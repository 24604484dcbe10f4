// SPDX-License-Identifier: BSD-3-Clause
/// Decodes images ahead of the odometry, in order, on a separate thread or on the caller's.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "core/types/frame.h"

namespace stillpoint::bench {

/// Decoding time of one frame.
struct DecodedFrame {
  std::size_t index = 0;
  std::chrono::steady_clock::time_point start;
  std::chrono::nanoseconds elapsed{};
};

/// Returns frames 0, 1, ... `count - 1`; buffers at most `ahead` decoded frames. The returned frames do not
/// depend on timing.
class FramePrefetcher {
 public:
  using Load = std::function<Frame(std::size_t index)>;

  /// @param load  called on the prefetching thread only
  /// @param ahead 0: no thread is started; `take` decodes on the calling thread
  FramePrefetcher(Load load, std::size_t count, std::size_t ahead = 8);
  ~FramePrefetcher();
  FramePrefetcher(const FramePrefetcher&) = delete;
  FramePrefetcher& operator=(const FramePrefetcher&) = delete;

  /// Waits for a frame; earlier ones are dropped. Rethrows the exception of its decoding.
  /// @param index larger than at the last call, below `count`
  [[nodiscard]] Frame take(std::size_t index);

  /// Decoding times of the returned frames, in the order of the calls.
  [[nodiscard]] const std::vector<DecodedFrame>& decoded() const { return decoded_; }

 private:
  struct Slot {
    DecodedFrame decoded;
    Frame frame;
    std::exception_ptr error;
  };

  [[nodiscard]] Slot decode(std::size_t index) const;
  [[nodiscard]] Slot wait_for(std::size_t index);
  void decode_all();

  Load load_;
  std::size_t count_;
  std::size_t ahead_;
  std::size_t next_ = 0;  ///< smallest index that `take` accepts
  std::vector<DecodedFrame> decoded_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Slot> slots_;  ///< guarded by mutex_
  bool stopped_ = false;    ///< guarded by mutex_
  std::jthread thread_;
};

}  // namespace stillpoint::bench
