// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/run/profile_device.h"

#include <algorithm>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/profile/device_file.h"
#include "bench/record/output_folder.h"
#include "bench/record/result_values.h"
#include "bench/record/run_files.h"
#include "bench/run/run_result.h"
#include "eval/metrics/statistics.h"

namespace stillpoint::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Dropped frames and latency on the simulated device.
struct DeviceTiming {
  std::size_t frames = 0;
  int dropped = 0;
  int late_detections = 0;
  std::int64_t beyond_budget = 0;  ///< poses with a latency above the budget
  double median_ms = 0.0;          ///< of the latencies
  double p95_ms = 0.0;
  double max_ms = 0.0;
};

DeviceTiming timing_of(const RunSummary& summary, double budget_ms) {
  const RealtimeReport report = summary.realtime.value_or(RealtimeReport{});
  const std::vector<double>& latencies = report.latencies_ms;
  return {.frames = summary.frames,
          .dropped = report.dropped,
          .late_detections = report.late_detections,
          .beyond_budget = std::ranges::count_if(latencies, [&](double ms) { return ms > budget_ms; }),
          .median_ms = eval::percentile(latencies, 0.5).value_or(0.0),
          .p95_ms = eval::percentile(latencies, 0.95).value_or(0.0),
          .max_ms = eval::percentile(latencies, 1.0).value_or(0.0)};
}

/// One run on a simulated device.
struct SimulatedRun {
  DeviceFile device;
  bool deterministic = false;
  double budget_ms = 0.0;
  RunResult result;
  DeviceTiming timing;
};

Json json_of(const SimulatedRun& run) {
  const auto& [device, deterministic, budget_ms, result, timing] = run;
  return {{"device", device.title},
          {"source", device.source},
          {"deterministic", deterministic},
          {"sequence", result.sequence},
          {"status", status_name(result.outcome)},
          {"frames", timing.frames},
          {"dropped", timing.dropped},
          {"late_detections", timing.late_detections},
          {"budget_ms", budget_ms},
          {"beyond_budget", timing.beyond_budget},
          {"latency_ms", {{"median", timing.median_ms}, {"p95", timing.p95_ms}, {"max", timing.max_ms}}},
          {"score", metric_members({.scored = measurements_of(result).scored})}};
}

void print(const SimulatedRun& run) {
  const auto& [device, deterministic, budget_ms, result, timing] = run;
  std::cout << fmt::format(
      "{}\n{}\n{} frames, {} dropped, {} with late detections; latency {:.1f} ms (median), {:.1f} ms (p95), "
      "{:.1f} ms (max), {} frames above {:g} ms\n",
      device.title,
      deterministic ? "fixed stage costs: the result is deterministic"
                    : "scaled measured times: the result varies between runs",
      timing.frames, timing.dropped, timing.late_detections, timing.median_ms, timing.p95_ms, timing.max_ms,
      timing.beyond_budget, budget_ms);
  std::cout << result.sequence << ": " << status_name(result.outcome) << '\n'
            << score_text(*measurements_of(result).scored);
}

}  // namespace

int profile_on_device(const datasets::SensorStream& stream, DeviceRequest request) {
  SimulatedRun run{.device = load_device(request.device), .budget_ms = request.budget_ms};
  request.spec.device = device_model(run.device);
  run.deterministic = request.spec.device->is_deterministic();
  ProgressLine progress(stream.info().name, stream.info().frame_times.size(), "frames");
  const auto on_update = [&](const OdometryUpdate& update) {
    progress.update(static_cast<std::size_t>(update.frame_id) + 1);
  };
  run.result = score_run(
      stream.info(),
      run_odometry(stream, request.spec,
                   {.on_update = on_update, .on_frame = {}, .stop_requested = interrupt_requested}));
  if (interrupt_requested()) return kExitInterrupted;
  run.timing = timing_of(run.result.run.summary, request.budget_ms);
  write_files(request.folder, {{"device.json", json_of(run).dump(2) + "\n"},
                               {"trajectory.tum", trajectory_text(run.result)}});
  progress.clear();
  print(run);
  std::cout << request.folder.string() << '\n';
  return run.result.outcome == Outcome::kOk ? kExitOk : kExitFindings;
}

}  // namespace stillpoint::bench
