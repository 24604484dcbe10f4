// SPDX-License-Identifier: BSD-3-Clause
#include "bench/plan/execution/outcome_scorer.h"

#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "bench/model/metrics.h"
#include "bench/plan/execution/plan_runner.h"
#include "bench/record/run_files.h"
#include "core/base/error.h"
#include "core/base/thread_name.h"
#include "datasets/open_sequence.h"
#include "eval/io/trajectory_file.h"
#include "eval/protocols/protocol.h"
#include "eval/trajectory/alignment.h"

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

/// @param contained only the wall time is that of the system
std::vector<Metric> process_metrics(const ProcessResult& end, bool contained) {
  std::vector<Metric> metrics =
      measured_metrics({.process = ProcessCost{.wall_s = end.wall_s,
                                               .cpu_s = end.user_s + end.system_s,
                                               .peak_memory_bytes = end.peak_memory_bytes}});
  if (contained) std::erase_if(metrics, [](const Metric& metric) { return metric.name != "process_wall_s"; });
  return metrics;
}

std::vector<Metric> protocol_metrics(const eval::Evaluation& evaluation) {
  std::vector<Metric> metrics;
  const auto add = [&](std::string_view id, const std::optional<double>& value) {
    if (!value) return;
    metrics.push_back({.name = evaluation.protocol + "/" + std::string(id),
                       .protocol = evaluation.text,
                       .unit = std::string(find_metric(id)->unit),
                       .value = *value});
  };
  const auto rmse = [](const std::optional<eval::Statistics>& errors) {
    return errors ? std::optional(errors->rmse) : std::nullopt;
  };
  add(metric_id::kAte, rmse(evaluation.ate_m));
  add(metric_id::kAteRotation, rmse(evaluation.ate_deg));
  add(metric_id::kRpeTranslationPerDelta, rmse(evaluation.rpe_m));
  add(metric_id::kRpeRotationPerDelta, rmse(evaluation.rpe_deg));
  if (evaluation.rpe_m) add(metric_id::kRpePairs, static_cast<double>(evaluation.rpe_pairs));
  add(metric_id::kDrift, evaluation.drift_percent);
  add(metric_id::kCorrectRate, evaluation.correct_rate);
  add(metric_id::kCoverage, evaluation.coverage);
  return metrics;
}

/// Attaches the ground-truth trajectory, and evaluates the estimate with the protocols of the plan. Protocols
/// that are not applicable to the run are logged and have no metrics.
RunOutcome with_ground_truth(RunOutcome outcome, const RunRequest& request, const BenchPlan& plan) {
  const auto text = outcome.attachments.find("trajectory");
  if (text == outcome.attachments.end() || outcome.outcome != Outcome::kOk) return outcome;
  const Trajectory estimate = eval::parse_tum(text->second, "trajectory", "camera").trajectory;
  const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(request.sequence);
  const datasets::GroundTruth& truth = stream->info().ground_truth;
  if (truth.trajectory.poses.empty()) return outcome;
  const Trajectory gt = eval::move_to_frame(truth.trajectory, truth.T_c_f.inverse(), "camera");
  outcome.attachments["truth"] = eval::format_tum(gt);
  for (const std::string& protocol : plan.protocols) {
    try {
      const std::vector<Metric> metrics =
          protocol_metrics(eval::evaluate(protocol, {.gt = gt, .est = estimate, .options = {}}));
      outcome.metrics.insert(outcome.metrics.end(), metrics.begin(), metrics.end());
    } catch (const InputError& error) {
      outcome.attachments["log"] += protocol + ": " + error.what() + "\n";
    }
  }
  return outcome;
}

}  // namespace

RunOutcome outcome_of_run(const SlamSystem& system, const RunRequest& request, const ProcessResult& end,
                          const BenchPlan& plan) {
  const std::optional<RunOutcome> terminated = termination_outcome(request, end, plan);
  RunOutcome outcome = terminated ? *terminated : reported_outcome(system, request, end);
  if (outcome.manifest.empty()) outcome.manifest = system.manifest(request);
  if (!end.messages.empty()) outcome.attachments["log"].insert(0, end.messages);
  outcome = with_ground_truth(std::move(outcome), request, plan);
  // Under valgrind, time and memory of the process are not those of the odometry.
  if (plan.kind == RunKind::kInstructions) return outcome;
  const std::vector<Metric> costs = process_metrics(end, system.is_contained());
  outcome.metrics.insert(outcome.metrics.end(), costs.begin(), costs.end());
  return outcome;
}

RunOutcome unless_changed(RunOutcome outcome, const std::string& changes) {
  if (changes.empty()) return outcome;
  RunOutcome changed{
      .outcome = Outcome::kBadData,
      .detail =
          "files of the sequence were changed during the run: " + changes +
          "; restore them; a program may write to {out} only, not to the sequence, which other runs read",
      .manifest = std::move(outcome.manifest)};
  changed.attachments["log"] = std::move(outcome.attachments["log"]);
  return changed;
}

void OutcomeScorer::start(std::size_t run, const ProcessResult& process, std::function<RunOutcome()> score) {
  scored_.push_back(std::async(std::launch::async, [this, run, process, score = std::move(score)] {
    name_this_thread("scoring");
    ScoredRun scored{.run = run, .process = process, .outcome = {}};
    const Stopwatch scoring;
    scored.outcome = score();
    scored.scoring_s = scoring.seconds();
    const Stopwatch writing;
    writer_.write_files(scored.outcome);
    scored.writing_s = writing.seconds();
    return scored;
  }));
}

bool OutcomeScorer::is_finished() const {
  return !scored_.empty() && scored_.front().wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

ScoredRun OutcomeScorer::take() {
  STILLPOINT_CHECK(!scored_.empty());
  std::future<ScoredRun> first = std::move(scored_.front());
  scored_.pop_front();
  return first.get();
}

}  // namespace stillpoint::bench
