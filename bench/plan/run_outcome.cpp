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
#include "eval/recipes/recipe.h"
#include "eval/trajectory/frames.h"

namespace stillpoint {
namespace {

std::string last_frame_text(const RunRequest& request) {
  const std::optional<std::int64_t> frame = read_heartbeat(request.work / kHeartbeatFile);
  return frame ? fmt::format(" after frame {}", *frame) : "";
}

/// How it ended, if not by itself.
std::optional<RunOutcome> violent_end(const RunRequest& request, const ProcessEnd& end,
                                      const BenchPlan& plan) {
  RunOutcome outcome;
  if (end.timed_out) {
    outcome.outcome = Outcome::kTimedOut;
    outcome.detail = fmt::format("took longer than {} s", plan.time_limit_s);
  } else if (end.out_of_memory) {
    outcome.outcome = Outcome::kOutOfMemory;
    outcome.detail = fmt::format("took more than {} MB of memory", plan.memory_limit_mb);
  } else if (end.signal != 0) {
    outcome.outcome = Outcome::kCrashed;
    outcome.detail = fmt::format("ended by signal {} ({})", end.signal, strsignal(end.signal));
  } else {
    return std::nullopt;
  }
  outcome.detail += last_frame_text(request);
  return outcome;
}

RunOutcome own_account(const SlamSystem& system, const RunRequest& request, const ProcessEnd& end) {
  try {
    return system.outcome(request, end);
  } catch (const InputError& error) {
    return {.outcome = Outcome::kCrashed, .detail = error.what()};
  }
}

void append_process(std::vector<Metric>& metrics, const ProcessEnd& end) {
  metrics.push_back({"process_wall_s", "wait4", "s", end.wall_s});
  metrics.push_back({"process_cpu_s", "wait4", "s", end.user_s + end.system_s});
  metrics.push_back(
      {"peak_memory_mb", "wait4", "MB", static_cast<double>(end.peak_memory_bytes) / 1048576.0});
}

void append_recipe(std::vector<Metric>& metrics, const Evaluation& evaluation) {
  const auto add = [&](const char* name, const char* unit, const std::optional<double>& value) {
    if (value) metrics.push_back({evaluation.recipe + "/" + name, evaluation.text, unit, *value});
  };
  const auto rmse = [](const std::optional<Statistics>& errors) {
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

/// Keeps the true path beside the estimate, and evaluates the estimate by the plan's recipes. A recipe that a
/// run does not allow has no numbers.
void append_truth(RunOutcome& outcome, const RunRequest& request, const BenchPlan& plan) {
  const auto text = outcome.attachments.find("trajectory");
  if (text == outcome.attachments.end() || outcome.outcome != Outcome::kOk) return;
  const Trajectory estimate = parse_tum(text->second, "trajectory", "camera").trajectory;
  const std::unique_ptr<SensorStream> stream = open_sequence(request.sequence);
  const GroundTruth& truth = stream->info().ground_truth;
  if (truth.trajectory.poses.empty()) return;
  const Trajectory gt = move_to_frame(truth.trajectory, truth.T_c_f.inverse(), "camera");
  outcome.attachments["truth"] = format_tum(gt);
  for (const std::string& recipe : plan.recipes) {
    try {
      append_recipe(outcome.metrics, evaluate(recipe, {.gt = gt, .est = estimate, .options = {}}));
    } catch (const InputError& error) {
      outcome.attachments["log"] += recipe + ": " + error.what() + "\n";
    }
  }
}

}  // namespace

RunOutcome outcome_of_run(const SlamSystem& system, const RunRequest& request, const ProcessEnd& end,
                          const BenchPlan& plan) {
  const std::optional<RunOutcome> violent = violent_end(request, end, plan);
  RunOutcome outcome = violent ? *violent : own_account(system, request, end);
  if (!end.messages.empty()) outcome.attachments["log"] = end.messages;
  append_truth(outcome, request, plan);
  // What valgrind took is not what the odometry takes.
  if (plan.kind != RunKind::kInstructions) append_process(outcome.metrics, end);
  return outcome;
}

}  // namespace stillpoint
