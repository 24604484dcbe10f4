// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runner.h"

#include <algorithm>
#include <utility>

#include "core/pipeline/runner_parts.h"

namespace stillpoint {

int RealtimeReport::deadline_misses() const {
  return static_cast<int>(
      std::ranges::count_if(latencies_ms, [this](double latency) { return latency > deadline_ms; }));
}

RunSummary run_sequential(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  Stages stages = assemble(input, config);
  ImuFeed imu_of_tracker(input.imu), imu_of_estimator(input.imu);
  // What the optimisation says after a picture takes the place of what was said the lag and one before.
  std::vector<Returned> returned(static_cast<std::size_t>(config.pipeline.feedback_lag) + 1,
                                 {stages.optimization.feedback(), {}});
  std::size_t oldest = 0;
  RunSummary summary;
  for (std::size_t i = 0; i < input.frame_times.size(); ++i) {
    if (control.stop_requested && control.stop_requested()) {
      summary.interrupted = true;
      break;
    }
    ++summary.frames;
    std::optional<PictureOnWay> picture = load_picture(input, i, summary.skipped);
    if (!picture) continue;
    const Timestamp imu_end = after(picture->frame.t, input.rig.time_offset_s + kImuLead_s);
    imu_of_tracker.up_to(imu_end, stages.tracking);
    imu_of_estimator.up_to(imu_end, stages.optimization);

    picture->full = stages.rate.admits(picture->frame.t);
    auto& [said, spent] = returned[oldest];
    picture->tracked = stages.tracking.process(picture->frame, picture->full, said, std::move(spent));
    std::optional<DetectionOnWay> detections;
    if (picture->full) detections = detect_objects(*stages.detector, picture->frame);
    close_picture(*picture, detections, stages.optimization, control, summary);
    said = stages.optimization.feedback(std::move(said));
    spent = std::move(picture->tracked);
    oldest = (oldest + 1) % returned.size();
  }
  close_run(stages, summary);
  return summary;
}

}  // namespace stillpoint
