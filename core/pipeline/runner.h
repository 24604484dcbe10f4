// SPDX-License-Identifier: BSD-3-Clause
/// Drives the stages over a sequence: the text of Paper Sec. II.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/channel_waits.h"
#include "core/pipeline/assembly.h"
#include "core/pipeline/board.h"
#include "core/types/odometry_update.h"

namespace stillpoint {

/// Everything about one picture, for dumps and videos; valid during the call.
struct PictureReport {
  const Frame& frame;
  const TrackedFrame& tracked;
  const DynamicReport& dynamic;  ///< empty at a picture that does not enter the window
  const OdometryUpdate& update;
};

/// Both callbacks are called on the thread that called the runner, in order of the pictures; any may be
/// empty.
struct RunControl {
  std::function<void(const OdometryUpdate&)> on_update;
  std::function<void(const PictureReport&)> on_picture;
  std::function<bool()> stop_requested;  ///< asked before each picture, from any thread
};

/// A picture that was skipped, and why.
struct SkippedFrame {
  std::size_t index = 0;
  std::string reason;
};

/// How a run kept up with the clock.
struct RealtimeReport {
  double deadline_ms = 0.0;          ///< interval of the pictures
  int dropped = 0;                   ///< pictures that made room for newer ones
  int late_detections = 0;           ///< pictures in the window whose boxes did not come in time
  std::vector<double> latencies_ms;  ///< from exposure to pose, one for each picture that got one
  [[nodiscard]] int deadline_misses() const;
};

struct RunSummary {
  std::size_t frames = 0;             ///< pictures asked for
  std::vector<SkippedFrame> skipped;  ///< of those, the ones that could not be read
  int resets = 0;                     ///< failures detected by the estimator
  ImuHealth imu_health;
  bool interrupted = false;  ///< stop was requested before the end
  std::string detector;      ///< what really looked for objects
  DetectorCounters detector_counters;
  std::vector<ChannelWaits> waits;         ///< between the threads; none where there is one
  std::optional<RealtimeReport> realtime;  ///< of `run_realtime` and `run_on_board`
};

/// One thread, picture by picture; the same input and config give the same bits.
/// @throws InputError if the config asks for what the input lacks (e.g. an IMU), or no picture can be read
[[nodiscard]] RunSummary run_sequential(const SensorInput& input, const OdometryConfig& config,
                                        const RunControl& control);

/// A thread each for tracking, detection and optimisation. The feedback to the tracker has the config's lag,
/// so that the result equals that of `run_sequential` to the bit.
/// @throws InputError as `run_sequential`
[[nodiscard]] RunSummary run_pipelined(const SensorInput& input, const OdometryConfig& config,
                                       const RunControl& control);

/// The same threads, and pictures that come when their stamps say: what is not ready in time is dropped or
/// late, and counted.
/// @param speed of the clock; 1 = as recorded, > 0
/// @throws InputError as `run_sequential`
[[nodiscard]] RunSummary run_realtime(const SensorInput& input, const OdometryConfig& config,
                                      const RunControl& control, double speed);

/// A virtual clock, and the machine that is thought to run beside it.
struct BoardClock {
  BoardModel board;
  double speed = 1.0;  ///< of the recording's time, > 0
};

/// What `run_realtime` would do on another machine: pictures come by their stamps on a virtual clock, stages
/// take as long as the board needs, what is not ready in time is dropped or late. Accuracy and speed of the
/// board come of one run. With fixed costs the same input gives the same bits; without costs those of
/// `run_sequential` (feedback lag 0). Two simplifications: a busy detector lets a picture pass instead of
/// keeping it in mind, and inertial samples are there without delay.
/// @throws InputError as `run_sequential`
[[nodiscard]] RunSummary run_on_board(const SensorInput& input, const OdometryConfig& config,
                                      const RunControl& control, const BoardClock& clock);

}  // namespace stillpoint
