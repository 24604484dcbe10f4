// SPDX-License-Identifier: BSD-3-Clause
/// Queue of the received IMU samples, and the times up to which a frame needs them.
///
/// A stage gets the samples up to the exposure of a frame plus a lookahead, however early later ones were
/// received: its results are then independent of timing. Each stage has its own estimate of the time offset
/// between camera and IMU (the feedback to the tracker lags behind), and so its own position in the queue.
#pragma once

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstddef>
#include <limits>
#include <mutex>
#include <vector>

#include "core/config/odometry_config.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Samples up to this much later than an exposure are added before its frame, because the sample at the
/// exposure is interpolated.
constexpr double kImuLookahead_s = 0.02;

/// Time of the last IMU sample that is used with the frame at `t`.
/// @param time_offset_s estimate when the frame is processed: IMU time of the exposure minus `t`
[[nodiscard]] inline Timestamp imu_end_of(Timestamp t, double time_offset_s) {
  return after(t, time_offset_s + kImuLookahead_s);
}

/// Latest time that `imu_end_of` can return for the frame at `t`.
[[nodiscard]] inline Timestamp last_imu_end_of(Timestamp t, const OdometryConfig& config, const Rig& rig) {
  return imu_end_of(t, rig.time_offset_s + config.backend.time_offset_bound_s);
}

/// Time that the IMU samples must have reached before the frame at `t` is processed; the smallest timestamp
/// if the configuration does not use an IMU.
[[nodiscard]] inline Timestamp needed_imu(Timestamp t, const OdometryConfig& config, double time_offset_s) {
  constexpr Timestamp kNone{std::numeric_limits<std::int64_t>::min()};
  return config.imu.enabled ? imu_end_of(t, time_offset_s) : kNone;
}

/// First in, first out, with one position per reader. Any number of threads may add and read.
class ImuQueue {
 public:
  enum class Reader : std::size_t { kTracking, kOptimization, kPrediction };

  void add(const ImuSample& sample) {
    const std::scoped_lock lock(mutex_);
    samples_.push_back(sample);
    newest_ = std::max(newest_, sample.t);
    changed_.notify_all();
  }

  /// Announces that no more samples will be added, so that `wait_until` no longer waits.
  void finish() {
    const std::scoped_lock lock(mutex_);
    finished_ = true;
    changed_.notify_all();
  }

  /// Blocks until a sample at or after `t` has been added, or `finish` was called.
  void wait_until(Timestamp t) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return finished_ || newest_ >= t; });
  }

  /// Passes the samples up to time `end` that the reader has not read yet to `sink`, up to the first one that
  /// is later. Samples that all readers have read are removed.
  template <class Sink>
  void read_until(Reader reader, Timestamp end, const Sink& sink) {
    const std::scoped_lock lock(mutex_);
    std::size_t& next = next_[static_cast<std::size_t>(reader)];
    for (; next < samples_.size() && samples_[next].t <= end; ++next) sink(samples_[next]);
    const std::size_t read = *std::ranges::min_element(next_);
    samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(read));
    for (std::size_t& position : next_) position -= read;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  // All guarded by mutex_.
  std::vector<ImuSample> samples_;
  std::array<std::size_t, 3> next_{};                           ///< indices in `samples_`, by reader
  Timestamp newest_{std::numeric_limits<std::int64_t>::min()};  ///< latest sample added so far
  bool finished_ = false;
};

}  // namespace stillpoint
