// SPDX-License-Identifier: BSD-3-Clause
/// Odometry on threads of its own, one each for tracking, detection and optimization; results are delivered
/// by callbacks. Paper Sec. II.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/bounded_channel.h"
#include "core/base/module_timings.h"
#include "core/base/timestamp.h"
#include "core/config/odometry_config.h"
#include "core/pipeline/stages/frame_report.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/loop_report.h"
#include "core/types/nav_state.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"

namespace stillpoint {

/// What `ThreadedOdometry::add_frame` does if the queue of frames is full.
enum class FullQueuePolicy { kBlock, kDropOldest };

/// Callbacks may be empty. They must not call a function of the odometry that blocks: `add_frame`, `finish`,
/// `stop`.
struct ThreadedOdometryOptions {
  /// Detector, called on the detection thread with the frames that enter the window, in order. Empty: no
  /// detections.
  std::function<DetectionSet(const Frame&)> detect;
  /// Called on the optimization thread; the report is valid during the call.
  FrameCallbacks on_frame;
  std::size_t queue_capacity = 2;  ///< frames waiting for IMU samples or the tracker, >= 1
  FullQueuePolicy full_queue = FullQueuePolicy::kBlock;
};

/// Same results as `Odometry`, bit by bit, for the frames that are not dropped and the same detections: the
/// feedback from optimization to tracking has the lag `pipeline.feedback_lag` (with 0, tracking and
/// optimization alternate).
///
/// Frames wait until their IMU samples have arrived. The tracker waits for those up to the exposure by the
/// time offset of its feedback, the optimization by its newest estimate; see `Odometry::needs_imu_until`.
/// Neither depends on timing, so the results do not. A thread that adds both frames and samples must not
/// block in `add_frame` while these are missing: it adds samples up to t + `Rig::time_offset_s` +
/// `backend.time_offset_bound_s` + 20 ms first, or uses `kDropOldest`.
///
/// `add_imu` and `add_frame` may be called by different threads, each by one at a time; `state`, `state_at`
/// and the counters by any thread.
///
/// An exception of a stage, the detector or a callback ends all three threads and is thrown by the next call
/// of `add_frame` or `finish`.
class ThreadedOdometry {
 public:
  /// Starts the threads.
  /// @throws InputError if the rig lacks a sensor that the configuration requires
  ThreadedOdometry(const OdometryConfig& config, const Rig& rig, ThreadedOdometryOptions options);
  /// Calls `stop`.
  ~ThreadedOdometry();
  ThreadedOdometry(const ThreadedOdometry&) = delete;
  ThreadedOdometry& operator=(const ThreadedOdometry&) = delete;

  /// As `Odometry::add_imu`. Never waits for a stage.
  void add_imu(const ImuSample& sample);

  /// Announces that no more samples will arrive, so that frames no longer wait for them and are processed
  /// with the samples there are; see `Odometry::track`.
  void finish_imu();

  /// Queues a frame, which must fulfil the conditions of `Odometry::track`.
  /// @param frame moved into the queue
  /// @param decoding time spent on decoding the images; added to the timings of the update
  /// @return false if a frame was lost: the oldest one of a full queue, or this one after `finish` or `stop`
  /// @throws InputError if the frame is earlier than the previous one; the exception of a thread, if any
  bool add_frame(Frame frame, const std::optional<ModuleSpan>& decoding = std::nullopt);

  /// Processes all queued frames, with the IMU samples there are, and ends the threads.
  /// @throws the exception of a thread, if any
  void finish();

  /// Ends the threads after the frames they are working on; discards all queued frames.
  void stop() noexcept;

  /// As `Odometry::state` and `Odometry::state_at`.
  [[nodiscard]] std::optional<NavState> state() const;
  [[nodiscard]] std::optional<NavState> state_at(Timestamp t) const;

  /// As `Odometry::use_map`. Call it before the first frame.
  void use_map(const KeyframeMap& map);

  /// After `finish`, once; as `Odometry::finish_loops`. The loop closure runs on a thread of its own.
  [[nodiscard]] std::optional<LoopReport> finish_loops();

  [[nodiscard]] std::size_t dropped_frames() const;  ///< by a full queue
  [[nodiscard]] ImuHealth imu_health() const;        ///< after the newest update
  /// Blocking times of the channels between the threads.
  [[nodiscard]] std::vector<ChannelWaits> waits() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillpoint
