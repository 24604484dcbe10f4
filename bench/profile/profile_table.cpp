// SPDX-License-Identifier: BSD-3-Clause
#include "bench/profile/profile_table.h"

#include <algorithm>
#include <array>
#include <chrono>

#include <nlohmann/json.hpp>

#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kStages = {Module::kTrackingThread, Module::kObjectDetection,
                                Module::kOptimizationThread};

Json json_of(const TimingStatistics& statistics) {
  return {{"mean", statistics.mean},
          {"median", statistics.median},
          {"p95", statistics.p95},
          {"p99", statistics.p99},
          {"max", statistics.max}};
}

}  // namespace

std::vector<ProfileRow> profile_rows(const TimingSamples& samples, double budget_ms) {
  std::vector<ProfileRow> rows;
  for (std::size_t i = 0; i < kModuleCount; ++i) {
    const auto module = static_cast<Module>(i);
    const std::optional<TimingStatistics> per_call = samples.statistics(module, TimePer::kCall);
    if (!per_call) continue;
    rows.push_back({.module = module,
                    .per_call = *per_call,
                    .per_frame = samples.statistics(module, TimePer::kFrame).value(),
                    .frames_over = samples.frames_over(module, budget_ms)});
  }
  return rows;
}

DeadlineMisses deadline_misses(const std::vector<ModuleTimings>& frames, double budget_ms) {
  DeadlineMisses misses{.budget_ms = budget_ms, .frames = static_cast<std::int64_t>(frames.size())};
  TimingSamples sums;
  for (const ModuleTimings& frame : frames) {
    ModuleTime sum{.calls = 1};
    std::int64_t slowest_ns = 0;
    for (const Module stage : kStages) {
      sum.ns += frame[stage].ns;
      slowest_ns = std::max(slowest_ns, frame[stage].ns);
    }
    sums.add(Module::kOptimizationThread, sum);
    misses.one_thread += 1e-6 * static_cast<double>(sum.ns) > budget_ms;
    misses.thread_per_stage += 1e-6 * static_cast<double>(slowest_ns) > budget_ms;
  }
  misses.whole_frame = sums.statistics(Module::kOptimizationThread);
  return misses;
}

Json profile_json(const std::vector<ProfileRow>& rows, const DeadlineMisses& misses) {
  Json modules = Json::array();
  for (const ProfileRow& row : rows) {
    modules.push_back({{"module", module_name(row.module)},
                       {"thread", is_thread(row.module)},
                       {"calls", row.per_call.calls},
                       {"per_call_ms", json_of(row.per_call)},
                       {"per_frame_ms", json_of(row.per_frame)},
                       {"frames_over_budget", row.frames_over}});
  }
  return {{"modules", modules},
          {"whole_frame_ms", misses.whole_frame ? json_of(*misses.whole_frame) : Json()},
          {"deadline",
           {{"budget_ms", misses.budget_ms},
            {"frames", misses.frames},
            {"missed_by_one_thread", misses.one_thread},
            {"missed_by_a_thread_per_stage", misses.thread_per_stage}}}};
}

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
    for (const Module stage : kStages) sum += frame[stage].ns;
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
