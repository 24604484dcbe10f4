// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint systems run` executes another system on one sequence, without a store.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/model/metrics.h"
#include "bench/plan/execution/outcome_scorer.h"
#include "bench/plan/plan_matrix.h"
#include "bench/process/child_process.h"
#include "bench/profile/meters/run_monitor.h"
#include "bench/record/output_folder.h"
#include "bench/systems/external_run.h"
#include "bench/systems/file_states.h"
#include "core/base/error.h"
#include "reports/tables/text_format.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct SystemRunArguments {
  std::string system;
  std::string sequence;
  std::string out;
  std::string fault;
  std::vector<std::string> settings;
  int max_frames = 0;  ///< 0 = all
  double time_limit_s = 3600.0;
  int memory_limit_mb = 0;  ///< 0 = none
};

bool is_preset(const std::string& name) {
  try {
    return !matching_presets({name}).empty();
  } catch (const InputError&) {
    return false;
  }
}

/// A plan of one run.
BenchPlan single_run_plan(const SystemRunArguments& arguments) {
  BenchPlan plan;
  plan.name = "systems run";
  if (is_preset(arguments.sequence)) {
    plan.rendered.sequences = {arguments.sequence};
    plan.rendered.seconds = 0.0;
  } else {
    const bool is_here = fs::exists(arguments.sequence) && arguments.sequence.find('/') == std::string::npos;
    plan.recorded.sequences = {is_here ? "./" + arguments.sequence : arguments.sequence};
  }
  if (!arguments.fault.empty()) {
    if (!reaches_external_systems(arguments.fault))
      throw InputError("--fault", "\"" + arguments.fault + "\" does not reach another program");
    plan.faults = {arguments.fault};
  }
  plan.max_frames = arguments.max_frames;
  plan.time_limit_s = arguments.time_limit_s;
  plan.memory_limit_mb = arguments.memory_limit_mb;
  return plan_of_system(std::move(plan), arguments.system);
}

/// The system with the values of --set param.NAME=VALUE.
ExternalSystem with_parameters(ExternalSystem system, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    const std::string key = setting.substr(0, equals);
    const bool is_known = equals != std::string::npos && key.starts_with(kParamPrefix) &&
                          system.param.contains(key.substr(kParamPrefix.size()));
    if (!is_known) {
      std::vector<std::string> names;
      for (const auto& [name, value] : system.param) names.push_back(name);
      throw InputError(
          "--set", fmt::format("\"{}\" sets no parameter of {}; write param.NAME=VALUE; it has: {}", setting,
                               system.name, fmt::join(names, ", ")));
    }
    system.param[key.substr(kParamPrefix.size())] = setting.substr(equals + 1);
  }
  return system;
}

/// A process, and the energy of the machine while it ran.
struct MeasuredProcess {
  ProcessResult process;
  std::optional<DeviceScore> device;
};

/// @param frames of the sequence, for the energy per frame
MeasuredProcess execute_limited(ProcessSpec spec, const BenchPlan& plan, std::size_t frames) {
  spec.time_limit_s = plan.time_limit_s;
  if (plan.memory_limit_mb > 0) spec.memory_limit_bytes = std::int64_t{plan.memory_limit_mb} << 20;
  RunMonitor monitor("/");
  ProcessPool pool(interrupt_requested);
  pool.start(0, spec);
  MeasuredProcess measured{.process = pool.wait_next()->second, .device = {}};
  for (std::size_t i = 0; i < frames; ++i) monitor.frame_done();
  measured.device = monitor.finish();
  // The times of its frames are not known.
  if (measured.device) measured.device->joules_per_frame_sd.reset();
  return measured;
}

/// Times of modules and threads, as far as the system states them.
std::string times_text(const std::vector<ModuleCost>& costs) {
  if (costs.empty()) return "";
  report::TableRows table = {{"ms", "per", "mean", "median", "p95", "max", "calls"}};
  const auto ms = [](double value) { return fmt::format("{:.3f}", value); };
  for (const ModuleCost& cost : costs)
    table.push_back({cost.module, cost.per, ms(cost.mean_ms), ms(cost.median_ms), ms(cost.p95_ms),
                     ms(cost.max_ms), fmt::format("{}", cost.calls)});
  return report::format_table(table, report::TableStyle::kText);
}

std::size_t frames_of(const RunRequest& request) {
  const std::size_t all = played_sequence(request)->info().frame_times.size();
  return request.max_frames > 0 ? std::min(all, static_cast<std::size_t>(request.max_frames)) : all;
}

std::string result_text(const RunIdentity& identity, const RunOutcome& outcome) {
  const bool has_failed = outcome.outcome != Outcome::kOk;
  const bool is_doubtful = !has_failed && !outcome.detail.empty();
  Json json = {{"system", identity.variant},
               {"version", identity.build},
               {"sequence", identity.sequence},
               {"status", status_name(outcome.outcome)},
               {"failure", has_failed ? Json(outcome.detail) : Json(nullptr)},
               {"warnings", is_doubtful ? Json::array({outcome.detail}) : Json::array()}};
  json["protocols"] = Json::object();
  for (const Metric& metric : outcome.metrics) {
    json[metric.name] = metric.value;
    if (!metric.protocol.empty()) json["protocols"][metric.name] = metric.protocol;
  }
  for (const ModuleCost& cost : outcome.costs)
    json["timings"][cost.per == "frame" ? "threads" : "modules"][cost.module] = {{"calls", cost.calls},
                                                                                 {"mean", cost.mean_ms},
                                                                                 {"median", cost.median_ms},
                                                                                 {"p95", cost.p95_ms},
                                                                                 {"max", cost.max_ms}};
  return json.dump(2) + "\n";
}

/// "ATE 0.0123 m, ..."
std::string metrics_line(const RunOutcome& outcome) {
  std::vector<std::string> parts;
  for (const Metric& metric : outcome.metrics) {
    const MetricDescriptor* descriptor = find_metric(metric.name);
    if (descriptor != nullptr) parts.push_back(value_text(*descriptor, metric.value));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

int run_system(const SystemRunArguments& arguments) {
  install_interrupt_handlers();
  const BenchPlan plan = single_run_plan(arguments);
  const PlanMatrix matrix = expand_plan(plan, "", {});
  const PlannedRun& planned = matrix.runs.at(0);
  const ExternalRun external(with_parameters(matrix.systems.front(), arguments.settings));
  const fs::path folder = arguments.out.empty() ? fs::path("build/runs") / matrix.sequences.front().name /
                                                      folder_name(planned.identity.variant)
                                                : fs::path(arguments.out);
  require_safe_folder(folder,
                      {.names = {"result.json", "manifest.json", "program.log", "trajectory.tum", "out"},
                       .marks = {{"result.json", "manifest.json"}}},
                      {matrix.sequences.front().folder, matrix.systems.front().folder});
  require_writable(folder);
  const fs::path sequence =
      sequence_folder(matrix.sequences.front(), {.stop_requested = interrupt_requested});
  if (interrupt_requested()) return kExitInterrupted;
  const RunRequest request{.identity = planned.identity,
                           .max_frames = planned.max_frames,
                           .fault = planned.fault,
                           .sequence = sequence,
                           .work = folder / "out",
                           .time_limit_s = plan.time_limit_s,
                           .memory_limit_mb = plan.memory_limit_mb};
  fs::remove_all(request.work);
  SequenceWatch watch;
  static_cast<void>(watch.changes_of(sequence));
  const MeasuredProcess measured = execute_limited(external.command(request), plan, frames_of(request));
  if (interrupt_requested()) return kExitInterrupted;
  RunOutcome outcome =
      unless_changed(outcome_of_run(external, request, measured.process, plan), watch.changes_of(sequence));
  for (Metric& metric : measured_metrics({.device = measured.device}))
    outcome.metrics.push_back(std::move(metric));
  std::vector<OutputFile> files = {{"result.json", result_text(planned.identity, outcome)},
                                   {"manifest.json", outcome.manifest},
                                   {"program.log", outcome.attachments["log"]}};
  if (outcome.attachments.contains("trajectory"))
    files.push_back({"trajectory.tum", outcome.attachments["trajectory"]});
  write_files(folder, files);
  std::cout << fmt::format(
      "{} {}: {}{}{}\n  {}\n", planned.identity.sequence, planned.identity.variant,
      status_name(outcome.outcome), outcome.detail.empty() ? "" : ", ", outcome.detail,
      outcome.outcome == Outcome::kOk ? metrics_line(outcome) : (folder / "program.log").string());
  std::cout << times_text(outcome.costs);
  if (outcome.outcome == Outcome::kOk) std::cout << "  " << (folder / "result.json").string() << '\n';
  return outcome.outcome == Outcome::kOk ? kExitOk : kExitFindings;
}

}  // namespace

Command system_run_command() {
  const auto arguments = std::make_shared<SystemRunArguments>();
  return {
      .name = "run",
      .summary = "Run a system on one sequence; write trajectory, scores, messages and manifest",
      .example = "systems run my_slam.toml walking_xyz --set param.features=500 --out /tmp/run",
      .options = {{"SYSTEM", "Name of a shipped description, or a TOML file", &arguments->system},
                  {"SEQ", "Sequence folder, registered name or preset name", &arguments->sequence},
                  {"--set", "Override a parameter: param.NAME=VALUE; may be repeated", &arguments->settings},
                  {"--fault", "Inject a sensor fault, as for run", &arguments->fault},
                  {"--max-frames", "Only the first frames; 0 = all", &arguments->max_frames, {0, 1e9}},
                  {"--time-limit",
                   "Seconds after which it is terminated [3600]",
                   &arguments->time_limit_s,
                   {0.1, 1e6}},
                  {"--memory-limit",
                   "Limit in megabytes for it and its children; 0 = none",
                   &arguments->memory_limit_mb,
                   {0, 10000000}},
                  {"--out", "Output folder [build/runs/SEQ/SYSTEM]", &arguments->out}},
      .action = [arguments] { return run_system(*arguments); }};
}

}  // namespace stillpoint::bench
