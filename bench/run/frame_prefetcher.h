// SPDX-License-Identifier: BSD-3-Clause
/// Decodes pictures ahead of the odometry on a thread of its own, in order, or where they are asked for.
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

namespace stillpoint {

/// When a picture was decoded.
struct DecodedPicture {
  std::size_t index = 0;
  std::chrono::steady_clock::time_point start;
  std::chrono::nanoseconds elapsed{};
};

/// Hands out frames 0, 1, ... `count - 1`; at most `ahead` decoded ones wait. What is handed out does not
/// depend on timing.
class FramePrefetcher {
 public:
  using Load = std::function<Frame(std::size_t index)>;

  /// @param load  called on the prefetching thread only
  /// @param ahead 0: no thread is started, and `take` decodes
  FramePrefetcher(Load load, std::size_t count, std::size_t ahead = 8);
  ~FramePrefetcher();
  FramePrefetcher(const FramePrefetcher&) = delete;
  FramePrefetcher& operator=(const FramePrefetcher&) = delete;

  /// Waits for a frame; those before it are dropped. Throws what decoding it threw.
  /// @param index larger than at the last call, below `count`
  [[nodiscard]] Frame take(std::size_t index);

  /// Of each frame handed out, in the order of the calls.
  [[nodiscard]] const std::vector<DecodedPicture>& decoded() const { return decoded_; }

 private:
  struct Slot {
    DecodedPicture picture;
    Frame frame;
    std::exception_ptr error;
  };

  [[nodiscard]] Slot decode(std::size_t index) const;
  [[nodiscard]] Slot wait_for(std::size_t index);
  void decode_all();

  Load load_;
  std::size_t count_;
  std::size_t ahead_;
  std::size_t next_ = 0;  ///< the smallest index that may still be asked for
  std::vector<DecodedPicture> decoded_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Slot> slots_;  ///< guarded by mutex_
  bool stopped_ = false;    ///< guarded by mutex_
  std::jthread thread_;
};

}  // namespace stillpoint
