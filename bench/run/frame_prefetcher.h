// SPDX-License-Identifier: BSD-3-Clause
/// Decodes images ahead of the odometry on separate threads, or on the caller's.
#pragma once

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
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

/// How much is decoded in advance.
struct ReadAhead {
  std::size_t frames = 8;   ///< that are decoded or being decoded at any time; 0: `take` decodes on the
                            ///< calling thread
  std::size_t threads = 1;  ///< each decodes the next frame that no other one decodes
};

/// Returns frames 0, 1, ... `count - 1` in order. They do not depend on timing.
class FramePrefetcher {
 public:
  using Load = std::function<Frame(std::size_t index)>;

  /// @param load thread-safe if there are several threads
  FramePrefetcher(Load load, std::size_t count, ReadAhead ahead = {});
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
  /// The next frame to decode; nullopt if there is none or the prefetcher is destroyed. Waits for room.
  [[nodiscard]] std::optional<std::size_t> claim();
  void decode_all();

  Load load_;
  std::size_t count_;
  ReadAhead ahead_;
  std::size_t next_ = 0;  ///< smallest index that `take` accepts
  std::vector<DecodedFrame> decoded_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::size_t, Slot> slots_;  ///< decoded frames by index; guarded by mutex_, as are the next three
  std::size_t claimed_ = 0;            ///< frames that were given to a thread
  std::size_t released_ = 0;           ///< frames that were taken or dropped
  bool stopped_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace stillpoint::bench
