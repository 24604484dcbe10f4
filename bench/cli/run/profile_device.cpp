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
#include "bench/record/run_files.h"
#include "bench/record/score_text.h"
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

Json json_of(const DeviceFile& device, const DeviceModel& model, const RunResult& result,
             const DeviceTiming& timing, double budget_ms) {
  return {{"device", device.title},
          {"source", device.source},
          {"deterministic", model.is_deterministic()},
          {"sequence", result.sequence},
          {"status", status_name(result.status)},
          {"frames", timing.frames},
          {"dropped", timing.dropped},
          {"late_detections", timing.late_detections},
          {"budget_ms", budget_ms},
          {"beyond_budget", timing.beyond_budget},
          {"latency_ms", {{"median", timing.median_ms}, {"p95", timing.p95_ms}, {"max", timing.max_ms}}},
          {"score", score_members(result.score)}};
}

void print(const DeviceFile& device, const DeviceModel& model, const RunResult& result,
           const DeviceTiming& timing, double budget_ms) {
  std::cout << fmt::format(
      "{}\n{}\n{} frames, {} dropped, {} with late detections; latency {:.1f} ms (median), {:.1f} ms (p95), "
      "{:.1f} ms (max), {} frames above {:g} ms\n",
      device.title,
      model.is_deterministic() ? "fixed stage costs: the result is deterministic"
                               : "scaled measured times: the result varies between runs",
      timing.frames, timing.dropped, timing.late_detections, timing.median_ms, timing.p95_ms, timing.max_ms,
      timing.beyond_budget, budget_ms);
  std::cout << result.sequence << ": " << status_name(result.status) << '\n' << score_text(result.score);
}

}  // namespace

int profile_on_device(const datasets::SensorStream& stream, DeviceRequest request) {
  const DeviceFile device = load_device(request.device);
  const DeviceModel model = device_model(device);
  request.spec.device = model;
  ProgressLine progress(stream.info().name, stream.info().frame_times.size(), "frames");
  const auto on_update = [&](const OdometryUpdate& update) {
    progress.update(static_cast<std::size_t>(update.frame_id) + 1);
  };
  RunResult result = score_run(
      stream.info(),
      run_odometry(stream, request.spec,
                   {.on_update = on_update, .on_frame = {}, .stop_requested = interrupt_requested}));
  if (interrupt_requested()) return kExitInterrupted;
  const DeviceTiming timing = timing_of(result.run.summary, request.budget_ms);
  write_files(request.folder,
              {{"device.json", json_of(device, model, result, timing, request.budget_ms).dump(2) + "\n"},
               {"trajectory.tum", trajectory_text(result)}});
  progress.clear();
  print(device, model, result, timing, request.budget_ms);
  std::cout << request.folder.string() << '\n';
  return result.status == RunStatus::kOk ? kExitOk : kExitFindings;
}

}  // namespace stillpoint::bench
