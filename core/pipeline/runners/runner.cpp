// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/runners/runner.h"

#include <algorithm>
#include <utility>

#include "core/pipeline/runners/runner_parts.h"

namespace stillpoint {

int RealtimeReport::deadline_misses() const {
  return static_cast<int>(
      std::ranges::count_if(latencies_ms, [this](double latency) { return latency > deadline_ms; }));
}

RunSummary run_sequential(const SensorInput& input, const OdometryConfig& config, const RunControl& control) {
  Stages stages = assemble(input, config);
  ImuFeed imu_of_tracker(input.imu), imu_of_estimator(input.imu);
  // Ring buffer of `feedback_lag + 1` feedback messages.
  std::vector<TrackerFeedback> ring(static_cast<std::size_t>(config.pipeline.feedback_lag) + 1,
                                    {stages.optimization.feedback(), {}});
  std::size_t oldest = 0;
  RunSummary summary;
  for (std::size_t i = 0; i < input.frame_times.size(); ++i) {
    if (control.stop_requested && control.stop_requested()) {
      summary.interrupted = true;
      break;
    }
    ++summary.frames;
    std::optional<FrameJob> job = load_frame_job(input, i, summary.skipped);
    if (!job) continue;
    const Timestamp imu_end = after(job->frame.t, input.rig.time_offset_s + kImuLookahead_s);
    imu_of_tracker.feed_until(imu_end, stages.tracking);
    imu_of_estimator.feed_until(imu_end, stages.optimization);

    job->enters_window = stages.rate.admits(job->frame.t);
    auto& [feedback, recycled_frame] = ring[oldest];
    job->tracked =
        stages.tracking.process(job->frame, job->enters_window, feedback, std::move(recycled_frame));
    std::optional<DetectionJob> detections;
    if (job->enters_window) detections = detect_objects(*stages.detector, job->frame);
    finish_frame(*job, detections, stages.optimization, control, summary);
    feedback = stages.optimization.feedback(std::move(feedback));
    recycled_frame = std::move(job->tracked);
    oldest = (oldest + 1) % ring.size();
  }
  complete_summary(stages, summary);
  return summary;
}

}  // namespace stillpoint
