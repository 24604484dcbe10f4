// SPDX-License-Identifier: BSD-3-Clause
/// Runs the odometry over a sequence: its sensor data, the four modes, and what a run reports. Paper Sec. II.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/bounded_channel.h"
#include "core/config/odometry_config.h"
#include "core/detector/object_detector.h"
#include "core/pipeline/stages/frame_report.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/loop_report.h"
#include "core/types/rig.h"

namespace stillpoint {

/// Sensor data of a sequence. The spans must outlive the run.
struct SensorInput {
  Rig rig;
  std::span<const Timestamp> frame_times;  ///< ascending
  /// In order of time; a frame may arrive twice, and those beyond `frame_times` are ignored. Empty: each
  /// frame arrives at its timestamp.
  std::span<const FrameArrival> arrivals{};
  std::span<const ImuSample> imu;            ///< ascending; may be empty
  std::span<const DetectionSet> detections;  ///< recorded boxes; may be empty
  std::span<const DetectionSet> true_boxes;  ///< ground truth boxes; may be empty
  /// Injected faults: applied to the results of a network or a simulation; may be empty.
  std::function<DetectionSet(DetectionSet)> change_detections{};
  /// Decodes a frame; called by one thread at a time, with ascending index.
  /// @throws InputError for a frame that cannot be read
  std::function<Frame(std::size_t index)> load_frame;
  std::shared_ptr<const KeyframeMap> map;  ///< of an earlier run, for relocalization; may be null
};

/// Execution time of one call of a stage on the device.
struct StageCost {
  std::optional<double> fixed_ms;  ///< constant time; the optimization stage then takes no time for a frame
                                   ///< that does not enter the window
  double factor = 1.0;             ///< without `fixed_ms`: multiple of the time measured on this machine
};

/// Timing model of a target device.
struct DeviceModel {
  int cores = 2;                            ///< stages that can run at the same time, >= 1
  bool detector_has_own_processor = false;  ///< detection occupies no core
  StageCost tracking;
  StageCost detection;
  StageCost optimization;
  [[nodiscard]] bool is_deterministic() const {
    return tracking.fixed_ms && detection.fixed_ms && optimization.fixed_ms;
  }
};

struct RunControl {
  /// Invoked on one thread: that of the optimization in `run_pipelined`, else the one that called the runner.
  FrameCallbacks on_frame = {};
  std::function<bool()> stop_requested = {};  ///< polled before each frame, from any thread; may be empty
};

/// A frame that could not be read, and the error.
struct SkippedFrame {
  std::size_t index = 0;
  std::string reason;
};

/// Real-time performance of a run.
struct RealtimeReport {
  double deadline_ms = 0.0;          ///< frame interval
  int dropped = 0;                   ///< frames dropped from a full queue
  int late_detections = 0;           ///< frames that entered the window without timely detections
  std::vector<double> latencies_ms;  ///< from exposure to pose, for each frame with a pose
  [[nodiscard]] int deadline_misses() const;
};

struct RunSummary {
  std::size_t frames = 0;             ///< number of processed frames, including skipped and dropped ones
  std::vector<SkippedFrame> skipped;  ///< frames that could not be read
  int resets = 0;                     ///< resets after tracking failures
  ImuHealth imu_health;
  bool interrupted = false;  ///< stopped by `stop_requested`
  std::string detector;      ///< description of the detector
  DetectorCounters detector_counters;
  std::vector<ChannelWaits> waits;         ///< blocking times of the channels; empty if single-threaded
  std::optional<LoopReport> loops;         ///< if `loop.enabled`
  std::optional<RealtimeReport> realtime;  ///< only `run_realtime` and `run_on_device`
};

/// Single-threaded (`Odometry`), frame by frame. Deterministic: the same input and config give bit-identical
/// results.
/// @throws InputError if the input lacks data that the config requires (e.g. an IMU), or no frame is readable
[[nodiscard]] RunSummary run_sequential(const SensorInput& input, const OdometryConfig& config,
                                        const RunControl& control);

/// One thread each for tracking, detection and optimization (`ThreadedOdometry`), while the calling thread
/// loads the frames. The feedback to the tracker has the lag of the config, so that the result is
/// bit-identical to that of `run_sequential`.
/// @throws InputError as `run_sequential`
[[nodiscard]] RunSummary run_pipelined(const SensorInput& input, const OdometryConfig& config,
                                       const RunControl& control);

/// Same threads, with frames delivered at their timestamps. Frames that the tracker cannot accept are
/// dropped, detections that are not ready are late; both are counted.
/// @param speed playback speed, > 0; 1 = as recorded
/// @throws InputError as `run_sequential`
[[nodiscard]] RunSummary run_realtime(const SensorInput& input, const OdometryConfig& config,
                                      const RunControl& control, double speed);

/// Settings of a simulated run on a target device.
struct DeviceClock {
  DeviceModel device;
  double speed = 1.0;  ///< playback speed, > 0
};

/// Discrete-event simulation of `run_realtime` on a target device: frames are delivered at their timestamps
/// on a virtual clock, stages take the time given by the device model, and frames or detections that are not
/// ready in time are dropped or late. One run yields both accuracy and latency on the device. With fixed
/// costs the results are deterministic; with zero costs they equal those of `run_sequential` with feedback
/// lag 0. Two simplifications: a busy detector skips a frame instead of queueing it, and IMU samples arrive
/// without delay.
/// @throws InputError as `run_sequential`
[[nodiscard]] RunSummary run_on_device(const SensorInput& input, const OdometryConfig& config,
                                       const RunControl& control, const DeviceClock& clock);

}  // namespace stillpoint
