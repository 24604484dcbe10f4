// SPDX-License-Identifier: BSD-3-Clause
/// The steps of a frame, the same for all modes of execution. Paper Sec. II.
///
///   frame --> track ----------------> optimize --> update
///               ^     detections -->     |
///               +------- feedback -------+
///
/// A mode decides when a step is executed, on which thread, and how old the feedback is:
///
/// | mode            | class or function  | feedback                            | threads          |
/// |-----------------|--------------------|-------------------------------------|------------------|
/// | sequential      | `Odometry`         | `pipeline.feedback_lag` frames old  | of the caller    |
/// | pipelined       | `ThreadedOdometry` | same                                | one per step     |
/// | real time       | `run_realtime`     | newest one                          | one per step     |
/// | target device   | `run_on_device`    | newest one on the virtual clock     | of the caller    |
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "core/config/odometry_config.h"
#include "core/pipeline/imu_queue.h"
#include "core/pipeline/imu_rate_poses.h"
#include "core/pipeline/loop_worker.h"
#include "core/pipeline/stages/optimization_stage.h"
#include "core/pipeline/stages/stage_messages.h"
#include "core/pipeline/stages/tracking_stage.h"

namespace stillpoint {

/// Selects the frames that enter the window; the other frames get a predicted pose.
class WindowRate {
 public:
  /// @param rate_hz maximum rate of the window; 0 = every frame
  explicit WindowRate(double rate_hz) : rate_hz_(rate_hz) {}

  /// Whether a frame at `t` would enter the window, if it was the next one.
  [[nodiscard]] bool is_due(Timestamp t) const {
    return rate_hz_ <= 0.0 || !last_ || seconds_between(*last_, t) >= 1.0 / rate_hz_ - kSlack_s;
  }

  /// Records that the frame at `t` enters the window.
  void accept(Timestamp t) { last_ = t; }

 private:
  /// Tolerance of the interval, for timestamp jitter and because three intervals of 30 Hz, rounded to
  /// nanoseconds, are shorter than 0.1 s.
  static constexpr double kSlack_s = 0.005;

  double rate_hz_;
  std::optional<Timestamp> last_;
};

/// Rejects frames that arrive out of order.
class FrameOrder {
 public:
  /// @throws InputError if `t` is earlier than the last accepted frame
  void check(Timestamp t) const;
  void accept(Timestamp t) { last_ = t; }

 private:
  std::optional<Timestamp> last_;
};

/// Time after the exposure up to which the steps read IMU samples [s].
struct ImuLookahead {
  double tracking_s = kImuLookahead_s;
  double optimization_s = kImuLookahead_s;
};

/// Tracking, optimization, loop closure and the prediction at IMU rate of one odometry. `enters_window` and
/// `track` belong to one thread, `optimize` and what follows it to another; the two may be the same.
class FrameStepper {
 public:
  /// @throws InputError if the rig lacks a sensor that the configuration requires
  FrameStepper(const OdometryConfig& config, const Rig& rig, LoopExecution loop_execution,
               const ImuLookahead& lookahead = {});

  // --- any thread ---
  void add_imu(const ImuSample& sample) { imu_.add(sample); }
  /// As `ThreadedOdometry::finish_imu`.
  void finish_imu() { imu_.finish(); }
  /// Blocks until the samples have arrived that a step of the frame at `t` needs, or `finish_imu` was called.
  /// @param time_offset_s that the step uses: of the feedback, or the newest estimate
  void wait_for_imu(Timestamp t, double time_offset_s) {
    imu_.wait_until(needed_imu(t, config_, time_offset_s));
  }
  /// As `Odometry::state` and `Odometry::state_at`.
  [[nodiscard]] std::optional<NavState> state() const;
  [[nodiscard]] std::optional<NavState> state_at(Timestamp t);
  [[nodiscard]] ImuHealth imu_health() const;  ///< after the newest update

  // --- the thread of tracking ---
  /// Whether a frame at `t` would enter the window, if it was the next one.
  [[nodiscard]] bool enters_window(Timestamp t) const { return rate_.is_due(t); }
  /// Tracks the features of the next frame, with the IMU samples up to its exposure that there are.
  /// @param feedback newest that is available
  /// @param recycled a result that is no longer needed; its memory is reused
  /// @throws InputError for a frame of a wrong size or type; it is then ignored, but not its IMU samples
  [[nodiscard]] TrackedFrame track(const Frame& frame, const Feedback& feedback, TrackedFrame recycled = {});

  // --- the thread of the optimization ---
  /// Processes a tracked frame, with the IMU samples up to its exposure that there are, and corrects it by
  /// loop closure. @param detections null if the frame does not enter the window
  /// @return valid until the next call; the caller may add timings to it
  [[nodiscard]] OdometryUpdate& optimize(const TrackedFrame& tracked, const DetectionSet* detections);
  /// The same; adds the times of decoding and detection to the update.
  [[nodiscard]] OdometryUpdate& optimize(const FrameJob& job, const std::optional<DetectionJob>& detections);
  /// Feedback to the tracker. @param recycled a result that is no longer needed; its memory is reused
  [[nodiscard]] Feedback feedback(Feedback recycled = {}) const {
    return optimization_.feedback(std::move(recycled));
  }
  [[nodiscard]] double time_offset_s() const { return optimization_.motion_state().time_offset_s; }
  [[nodiscard]] const DynamicReport& dynamic() const { return optimization_.dynamic(); }
  [[nodiscard]] const OptimizationStage& optimization() const { return optimization_; }

  // --- before the first frame, and after the last one ---
  /// As `Odometry::use_map`.
  void use_map(const KeyframeMap& map);
  /// As `Odometry::finish_loops`.
  [[nodiscard]] std::optional<LoopReport> finish_loops();

 private:
  void publish(const OdometryUpdate& update);
  void read_all_samples();

  OdometryConfig config_;
  ImuLookahead lookahead_;
  ImuQueue imu_;
  WindowRate rate_;
  TrackingStage tracking_;
  OptimizationStage optimization_;
  std::unique_ptr<LoopWorker> loop_;  ///< null if off
  mutable std::mutex mutex_;
  StatePredictor predictor_;  ///< guarded by mutex_
  ImuHealth imu_health_;      ///< guarded by mutex_
};

}  // namespace stillpoint
