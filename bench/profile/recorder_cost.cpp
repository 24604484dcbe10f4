// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/recorder_cost.h"

#include <algorithm>
#include <chrono>

#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

constexpr int kBatches = 15;
constexpr int kFramesPerBatch = 200;
constexpr int kTimersPerFrame = 14;  // as in a frame, to amortize the growth of the vector alike

double timer_ns() {
  std::vector<double> batches;
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto start = std::chrono::steady_clock::now();
    for (int frame = 0; frame < kFramesPerBatch; ++frame) {
      ModuleTimings timings;
      for (int i = 0; i < kTimersPerFrame; ++i) const ScopedTimer timer(timings, Module::kFeatureTracking);
    }
    const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - start;
    batches.push_back(elapsed.count() / (kFramesPerBatch * kTimersPerFrame));
  }
  return eval::percentile(batches, 0.5).value_or(0.0);
}

double stages_ns(const OdometryRun& run) {
  std::int64_t sum = 0;
  for (const ModuleTimings& frame : run.frame_timings) {
    for (const Module stage :
         {Module::kTrackingThread, Module::kObjectDetection, Module::kOptimizationThread}) {
      sum += frame[stage].ns;
    }
  }
  return static_cast<double>(sum);
}

}  // namespace

RecorderCost recorder_cost(const OdometryRun& run) {
  RecorderCost cost{.timer_ns = timer_ns()};
  const double frames = std::max(1.0, static_cast<double>(run.frame_timings.size()));
  const auto recording_ns = static_cast<double>(run.recording.count());
  cost.timers_per_frame = static_cast<double>(run.spans.size()) / frames;
  cost.recording_us_per_frame = 1e-3 * recording_ns / frames;
  const double all_ns = static_cast<double>(run.spans.size()) * cost.timer_ns + recording_ns;
  cost.fraction = all_ns / std::max(1.0, stages_ns(run));
  return cost;
}

}  // namespace stillpoint::bench
