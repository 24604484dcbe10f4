// SPDX-License-Identifier: BSD-3-Clause
/// Executes the loop closure beside the odometry, and determines from which frame on its corrections are
/// used.
#pragma once

#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "core/base/bounded_channel.h"
#include "core/config/odometry_config.h"
#include "core/loop/loop_closure.h"
#include "core/pipeline/stages/optimization_stage.h"
#include "core/pipeline/thread_errors.h"
#include "core/types/rig.h"

namespace stillpoint {

enum class LoopExecution {
  kInline,    ///< on the calling thread, at once
  kThread,    ///< on a thread of its own
  kRealtime,  ///< same; corrections are used as soon as they are known, and keyframes are dropped under load
};

/// One thread at a time may use an object. `kInline` and `kThread` give the same corrections to the bit: that
/// of a keyframe which left the window with frame k is used from frame k + `loop.lag_frames` on. `kThread`
/// waits for it there, and not before. While the segment is not located in the map, that is at the start with
/// a loaded map and after a loss, current frames are looked up at a fixed cadence, and all lags are at most 5
/// frames.
class LoopWorker {
 public:
  /// @throws InputError as the constructor of `LoopClosure`
  LoopWorker(const OdometryConfig& config, const Rig& rig, LoopExecution execution);
  ~LoopWorker();
  LoopWorker(const LoopWorker&) = delete;
  LoopWorker& operator=(const LoopWorker&) = delete;

  /// As `LoopClosure::use_map`. Call it before the first frame.
  void use_map(const KeyframeMap& map);

  /// Takes the keyframe that left the window with the newest frame, and sets `OdometryUpdate::T_m_w` and
  /// `in_map`.
  /// @throws the exception of the thread, if any
  void correct(OptimizationStage& optimization, OdometryUpdate& update);

  /// Takes the keyframes that are still in the window. Call it once, after the last frame.
  /// @throws the exception of the thread, if any
  [[nodiscard]] LoopReport finish(OptimizationStage& optimization);

 private:
  struct Job {
    DepartedKeyframe keyframe;
    bool is_current = false;  ///< a frame to locate in the map, not a keyframe
  };
  struct Result {
    Pose T_m_w;
    bool located = false;
    DepartedKeyframe used;  ///< to be recycled
  };

  void run();
  [[nodiscard]] Result process(Job job);
  void enter_segment(int segment);
  void add(Job job);
  void look_up(OptimizationStage& optimization, const OdometryUpdate& update);
  void collect(Result result);
  /// Waits for the result of the oldest outstanding keyframe.
  void collect_next();

  LoopExecution execution_;
  std::int64_t lag_frames_;
  LoopClosure closure_;  ///< of the thread, while it runs
  std::int64_t frame_ = 0;
  std::vector<std::int64_t> due_;  ///< frames from which on the corrections of submitted jobs are used
  std::vector<Result> results_;    ///< of the oldest of them
  std::size_t outstanding_ = 0;    ///< jobs in the thread and its channels
  int dropped_ = 0;
  int segment_ = 0;                ///< of the newest frame
  bool located_ = true;            ///< in the map
  std::int64_t next_look_up_ = 0;  ///< frame
  int look_ups_ = 0;               ///< in this segment
  Pose T_m_w_;
  BoundedChannel<Job> to_thread_;
  BoundedChannel<Result> from_thread_;
  ThreadErrors errors_;
  std::jthread thread_;  ///< last member: joined before the others are destroyed
};

}  // namespace stillpoint
