// SPDX-License-Identifier: BSD-3-Clause
/// Drives the stages over a sequence: the text of Paper Sec. II.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/imu/imu_buffer.h"
#include "core/pipeline/odometry_config.h"
#include "core/types/detection.h"
#include "core/types/frame.h"
#include "core/types/odometry_update.h"
#include "core/types/rig.h"

namespace stillpoint {

/// A sequence as the runners see it; the spans outlive the run.
struct SensorInput {
  Rig rig;
  std::span<const Timestamp> frame_times;              ///< rising
  std::span<const ImuSample> imu;                      ///< rising; may be empty
  std::span<const DetectionSet> detections;            ///< recorded boxes; may be empty
  std::function<Frame(std::size_t index)> load_frame;  ///< throws InputError for a picture that cannot be had
};

struct RunControl {
  std::function<void(const OdometryUpdate&)> on_update;  ///< called once per picture, in order
  std::function<bool()> stop_requested;                  ///< asked before each picture; may be empty
};

/// A picture that was skipped, and why.
struct SkippedFrame {
  std::size_t index = 0;
  std::string reason;
};

struct RunSummary {
  std::size_t frames = 0;             ///< pictures asked for
  std::vector<SkippedFrame> skipped;  ///< of those, the ones that could not be read
  int resets = 0;                     ///< failures detected by the estimator
  ImuHealth imu_health;
  bool interrupted = false;  ///< stop was requested before the end
};

/// One thread, picture by picture; the same input and config give the same bits.
/// @throws InputError if the config asks for what the input lacks (e.g. an IMU), or more pictures fail than
/// the config allows
[[nodiscard]] RunSummary run_sequential(const SensorInput& input, const OdometryConfig& config,
                                        const RunControl& control);

}  // namespace stillpoint
