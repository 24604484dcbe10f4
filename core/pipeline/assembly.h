// SPDX-License-Identifier: BSD-3-Clause
/// The stages put together from a configuration: the one place that branches on it.
#pragma once

#include <memory>

#include "core/detector/object_detector.h"
#include "core/pipeline/optimization_stage.h"
#include "core/pipeline/sensor_input.h"
#include "core/pipeline/tracking_stage.h"
#include "core/pipeline/window_rate.h"

namespace stillpoint {

/// One odometry over one sequence. The stages share nothing: each may live on a thread of its own.
struct Stages {
  WindowRate rate;
  TrackingStage tracking;
  std::unique_ptr<ObjectDetector> detector;
  OptimizationStage optimization;
};

/// @throws InputError if the input lacks what the configuration asks for, or a network cannot be loaded
[[nodiscard]] Stages assemble(const SensorInput& input, const OdometryConfig& config);

}  // namespace stillpoint
