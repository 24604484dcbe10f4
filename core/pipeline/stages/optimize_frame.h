// SPDX-License-Identifier: BSD-3-Clause
/// Last step of a frame: the optimization stage.
#pragma once

#include "core/pipeline/stages/optimization_stage.h"
#include "core/pipeline/stages/stage_messages.h"

namespace stillpoint {

/// Runs the optimization stage, and adds the timings of the other stages to its update.
/// @param detections nullopt if the frame does not enter the window
/// @return as `OptimizationStage::process`
[[nodiscard]] inline OdometryUpdate& optimize_frame(const FrameJob& job,
                                                    const std::optional<DetectionJob>& detections,
                                                    OptimizationStage& optimization) {
  OdometryUpdate& update = job.enters_window ? optimization.process(job.tracked, detections->set)
                                             : optimization.predict(job.tracked);
  if (job.decoding) update.timings.add(*job.decoding, 1);
  update.timings.add(job.tracked.timings);
  if (detections && detections->timing) update.timings.add(*detections->timing, 1);
  return update;
}

}  // namespace stillpoint
