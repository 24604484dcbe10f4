// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/run_outcome.h"

#include <cstring>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include "bench/run/heartbeat.h"
#include "core/base/error.h"
#include "datasets/sensor_stream.h"
#include "eval/io/trajectory_file.h"
#include "eval/protocols/protocol.h"
#include "eval/trajectory/frames.h"

namespace stillpoint::bench {
namespace {

std::string last_frame_text(const RunRequest& request) {
  const std::optional<std::int64_t> frame = read_heartbeat(request.work / kHeartbeatFile);
  return frame ? fmt::format(" after frame {}", *frame) : "";
}

/// The outcome of a process that was terminated by a limit or a signal.
std::optional<RunOutcome> termination_outcome(const RunRequest& request, const ProcessResult& end,
                                              const BenchPlan& plan) {
  RunOutcome outcome;
  if (end.timed_out) {
    outcome.outcome = Outcome::kTimedOut;
    outcome.detail = fmt::format("exceeded the time limit of {} s", plan.time_limit_s);
  } else if (end.out_of_memory) {
    outcome.outcome = Outcome::kOutOfMemory;
    outcome.detail = fmt::format("exceeded the memory limit of {} MB", plan.memory_limit_mb);
  } else if (end.signal != 0) {
    outcome.outcome = Outcome::kCrashed;
    outcome.detail = fmt::format("terminated by signal {} ({})", end.signal, strsignal(end.signal));
  } else {
    return std::nullopt;
  }
  outcome.detail += last_frame_text(request);
  return outcome;
}

RunOutcome reported_outcome(const SlamSystem& system, const RunRequest& request, const ProcessResult& end) {
  try {
    return system.outcome(request, end);
  } catch (const InputError& error) {
    return {.outcome = Outcome::kCrashed, .detail = error.what()};
  }
}

void append_process(std::vector<Metric>& metrics, const ProcessResult& end) {
  metrics.push_back({"process_wall_s", "wait4", "s", end.wall_s});
  metrics.push_back({"process_cpu_s", "wait4", "s", end.user_s + end.system_s});
  metrics.push_back(
      {"peak_memory_mb", "wait4", "MB", static_cast<double>(end.peak_memory_bytes) / 1048576.0});
}

void append_protocol(std::vector<Metric>& metrics, const eval::Evaluation& evaluation) {
  const auto add = [&](const char* name, const char* unit, const std::optional<double>& value) {
    if (value) metrics.push_back({evaluation.protocol + "/" + name, evaluation.text, unit, *value});
  };
  const auto rmse = [](const std::optional<eval::Statistics>& errors) {
    return errors ? std::optional(errors->rmse) : std::nullopt;
  };
  add("ate_rmse_m", "m", rmse(evaluation.ate_m));
  add("ate_rmse_deg", "deg", rmse(evaluation.ate_deg));
  add("rpe_rmse_m", "m", rmse(evaluation.rpe_m));
  add("rpe_rmse_deg", "deg", rmse(evaluation.rpe_deg));
  add("drift_percent", "%", evaluation.drift_percent);
  add("correct_rate", "", evaluation.correct_rate);
  add("coverage", "", evaluation.coverage);
}

/// Attaches the ground-truth trajectory, and evaluates the estimate with the protocols of the plan. Protocols
/// that are not applicable to the run are logged and have no metrics.
void append_ground_truth(RunOutcome& outcome, const RunRequest& request, const BenchPlan& plan) {
  const auto text = outcome.attachments.find("trajectory");
  if (text == outcome.attachments.end() || outcome.outcome != Outcome::kOk) return;
  const Trajectory estimate = eval::parse_tum(text->second, "trajectory", "camera").trajectory;
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(request.sequence);
  const datasets::GroundTruth& truth = stream->info().ground_truth;
  if (truth.trajectory.poses.empty()) return;
  const Trajectory gt = eval::move_to_frame(truth.trajectory, truth.T_c_f.inverse(), "camera");
  outcome.attachments["truth"] = eval::format_tum(gt);
  for (const std::string& protocol : plan.protocols) {
    try {
      append_protocol(outcome.metrics, eval::evaluate(protocol, {.gt = gt, .est = estimate, .options = {}}));
    } catch (const InputError& error) {
      outcome.attachments["log"] += protocol + ": " + error.what() + "\n";
    }
  }
}

}  // namespace

RunOutcome outcome_of_run(const SlamSystem& system, const RunRequest& request, const ProcessResult& end,
                          const BenchPlan& plan) {
  const std::optional<RunOutcome> terminated = termination_outcome(request, end, plan);
  RunOutcome outcome = terminated ? *terminated : reported_outcome(system, request, end);
  if (!end.messages.empty()) outcome.attachments["log"] = end.messages;
  append_ground_truth(outcome, request, plan);
  // Under valgrind, time and memory of the process are not those of the odometry.
  if (plan.kind != RunKind::kInstructions) append_process(outcome.metrics, end);
  return outcome;
}

}  // namespace stillpoint::bench
