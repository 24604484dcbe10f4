// SPDX-License-Identifier: BSD-3-Clause
/// Construction of the stages from a configuration.
#pragma once

#include <memory>

#include "core/detector/object_detector.h"
#include "core/pipeline/sensor_input.h"
#include "core/pipeline/stages/optimization_stage.h"
#include "core/pipeline/stages/tracking_stage.h"
#include "core/pipeline/window_rate.h"

namespace stillpoint {

/// Stages of one odometry run. They share no state, so that each can run on its own thread.
struct Stages {
  WindowRate rate;
  TrackingStage tracking;
  std::unique_ptr<ObjectDetector> detector;
  OptimizationStage optimization;
};

/// Detector of the configuration; none if the mask is off.
/// @throws InputError if the input lacks data that the detector requires, or a network cannot be loaded
[[nodiscard]] std::unique_ptr<ObjectDetector> make_detector(const SensorInput& input,
                                                            const OdometryConfig& config);

/// @throws InputError as `make_detector`, or if the rig lacks a sensor that the configuration requires
[[nodiscard]] Stages assemble(const SensorInput& input, const OdometryConfig& config);

}  // namespace stillpoint
