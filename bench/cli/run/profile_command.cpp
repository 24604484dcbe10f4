// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint profile`: times, energy and allocations of one run; with --device accuracy and latency on a
// simulated target device, with --instructions instruction counts of callgrind.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/run/profile_report.h"
#include "bench/config/config_file.h"
#include "bench/config/toml_source.h"
#include "bench/plan/bench_plan.h"
#include "bench/plan/plan_sequences.h"
#include "bench/process/child_process.h"
#include "bench/profile/device_file.h"
#include "bench/profile/instruction_count.h"
#include "bench/profile/meters/device_info.h"
#include "bench/profile/meters/process_usage.h"
#include "bench/profile/profile_table.h"
#include "bench/profile/timeline.h"
#include "bench/record/output_folder.h"
#include "bench/record/result_values.h"
#include "bench/record/run_files.h"
#include "bench/run/odometry_run.h"
#include "bench/run/run_result.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "datasets/sensor_stream.h"
#include "eval/io/text_reader.h"
#include "eval/metrics/statistics.h"
#include "reports/tables/text_format.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A run on a simulated device.
struct DeviceRequest {
  std::string device;  ///< embedded name or TOML file
  std::string config;  ///< of `spec`
  RunSpec spec;        ///< `device` is not set
  double budget_ms = 0.0;
  fs::path folder;  ///< output: device.json and trajectory.tum
};

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
  return {{"schema", 1},
          {"device", device.title},
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
            << score_text(measurements_of(result));
}

/// Simulates the device and prints the result. @return exit code
/// @throws InputError if the device does not exist; rethrows errors of the run
int profile_on_device(const datasets::SensorStream& stream, DeviceRequest request) {
  SimulatedRun run{.device = load_device(request.device), .budget_ms = request.budget_ms};
  request.spec.device = device_model(run.device);
  run.deterministic = request.spec.device->is_deterministic();
  if (!request.config.starts_with(run.device.config))
    spdlog::warn(
        "--device {}: its stage costs are those of \"{}\", not of \"{}\": dropped frames and latencies are "
        "those "
        "of a system as slow; add --config {}, or use a device with costs scaled from this machine",
        request.device, run.device.config, request.config, run.device.config);
  ProgressLine progress(stream.info().name, stream.info().frame_times.size(), "frames");
  const auto on_frame = [&](const FrameReport& report) {
    progress.update(static_cast<std::size_t>(report.update.frame_id) + 1);
  };
  run.result = score_run(
      stream.info(),
      run_odometry(stream, request.spec, {.on_frame = {on_frame}, .stop_requested = interrupt_requested}));
  if (interrupt_requested()) return kExitInterrupted;
  run.timing = timing_of(run.result.run.summary, request.budget_ms);
  write_profile(request.folder, {{"device.json", json_of(run).dump(2) + "\n"},
                                 {"trajectory.tum", trajectory_text(run.result)}});
  progress.clear();
  print(run);
  std::cout << request.folder.string() << '\n';
  return run.result.outcome == Outcome::kOk ? kExitOk : kExitFindings;
}

/// A run under callgrind.
struct InstructionRequest {
  fs::path sequence;  ///< folder
  std::string name;   ///< name of the sequence
  ConfigRequest config;
  int frames = 0;   ///< number of frames, from the start
  fs::path folder;  ///< output: instructions.json, callgrind.out and the files of the run
};

using FunctionCount = std::pair<std::string, std::int64_t>;

constexpr std::size_t kListedFunctions = 15;
constexpr std::size_t kListedCharacters = 100;

ProcessSpec run_of(const InstructionRequest& request) {
  ProcessSpec run;
  run.program = executable_path();
  run.arguments = {"run",
                   fs::absolute(request.sequence).string(),
                   "--config",
                   request.config.base,
                   "--variant",
                   request.config.variant,
                   "--out",
                   ".",
                   "--force",
                   "--max-frames",
                   std::to_string(request.frames),
                   "--sequence-id",
                   "unused"};
  for (const std::string& setting : request.config.settings) {
    run.arguments.insert(run.arguments.end(), {"--set", setting});
  }
  return under_callgrind(std::move(run), fs::absolute(request.folder));
}

/// Functions with the largest self counts.
std::vector<FunctionCount> largest_self_counts(const CallgrindCounts& counts) {
  std::vector<FunctionCount> functions(counts.self.begin(), counts.self.end());
  std::stable_sort(functions.begin(), functions.end(),
                   [](const FunctionCount& a, const FunctionCount& b) { return a.second > b.second; });
  functions.resize(std::min(functions.size(), kListedFunctions));
  return functions;
}

std::string in_millions(std::int64_t count, double divisor) {
  return fmt::format("{:.3f}", 1e-6 * static_cast<double>(count) / divisor);
}

void print(const std::vector<StageInstructions>& stages, const CallgrindCounts& counts, int frames) {
  report::TableRows table = {{"stage", "instructions", "million per frame"}};
  std::int64_t total = 0;
  for (const auto& [stage, count] : stages) {
    table.push_back({stage, fmt::format("{}", count), in_millions(count, frames)});
    total += count;
  }
  table.push_back({"all stages", fmt::format("{}", total), in_millions(total, frames)});
  std::cout << report::format_table(table, report::TableStyle::kText)
            << "\nfunctions with the largest self counts, whole program, millions (may vary between runs):\n";
  for (const auto& [function, count] : largest_self_counts(counts)) {
    std::cout << fmt::format("{:>12}  {}\n", in_millions(count, 1.0), function.substr(0, kListedCharacters));
  }
}

Json json_of(const InstructionRequest& request, const std::vector<StageInstructions>& stages,
             const CallgrindCounts& counts) {
  Json json = {{"schema", 1},
               {"sequence", request.name},
               {"base", request.config.base},
               {"variant", request.config.variant},
               {"frames", request.frames},
               {"stages", Json::object()},
               {"functions", Json::array()}};
  for (const auto& [stage, count] : stages) json["stages"][stage] = count;
  for (const auto& [function, count] : largest_self_counts(counts)) {
    json["functions"].push_back({{"name", function}, {"self", count}});
  }
  return json;
}

/// Counts instructions and prints them. @return exit code
/// @throws InputError if valgrind is not installed or the run fails
int profile_instructions(const InstructionRequest& request) {
  const ProcessSpec spec = run_of(request);
  spdlog::info("executing {} frames under callgrind, about 50 times slower than normal", request.frames);
  ProcessPool pool(interrupt_requested);
  pool.start(0, spec);
  const ProcessResult end = pool.wait_next()->second;
  if (interrupt_requested()) return kExitInterrupted;
  const fs::path file = request.folder / kCallgrindFile;
  if (end.signal != 0 || end.exit_code > kExitFindings) {
    throw InputError(request.sequence.string(), "the run under callgrind failed: " + last_line(end.messages));
  }
  const CallgrindCounts counts = parse_callgrind(eval::read_text_file(file), file.string());
  const std::vector<StageInstructions> stages = stage_instructions(counts, file.string());
  write_profile(request.folder, {{"instructions.json", json_of(request, stages, counts).dump(2) + "\n"}});
  print(stages, counts, request.frames);
  std::cout << fmt::format("{} (open callgrind.out in KCachegrind)\n", request.folder.string());
  return kExitOk;
}

/// Command line arguments of `profile`.
struct ProfileArguments {
  std::string sequence;
  std::string base = "stillpoint";
  std::string variant;
  std::vector<std::string> settings;
  std::string mode = "sequential";
  std::string out;
  std::string format;
  std::string rig;
  std::string cores;
  double budget_ms = 33.0;
  int max_frames = 0;
  bool instructions = false;
  std::string device;
  double speed = 1.0;
  std::string tegrastats;
  std::string duration;
  std::string sysfs_root = "/";
};

/// Samples the CPU times of all threads, during the run as its threads end with it.
class ThreadUsageSampler {
 public:
  void sample() {
    for (auto& [id, usage] : thread_usages()) threads_[id] = usage;
  }
  /// Usage since construction.
  [[nodiscard]] std::map<int, ThreadUsage> usages() const {
    std::map<int, ThreadUsage> since_start = threads_;
    for (const auto& [id, usage] : at_start_) {
      since_start[id].user_s -= usage.user_s;
      since_start[id].system_s -= usage.system_s;
    }
    return since_start;
  }

 private:
  std::map<int, ThreadUsage> at_start_ = thread_usages();
  std::map<int, ThreadUsage> threads_ = at_start_;
};

/// Energy since the construction.
class EnergyWatch {
 public:
  explicit EnergyWatch(const ProfileArguments& arguments)
      : meter_(arguments.sysfs_root, arguments.tegrastats, start_) {
    if (meter_.so_far()) samples_.push_back({});
  }

  /// @param frames processed so far
  void sample(std::int64_t frames) {
    const auto now = std::chrono::steady_clock::now();
    meter_.sample(now);
    const std::optional<EnergyUse> use = meter_.so_far();
    if (!use) return samples_.clear();
    samples_.push_back({.t_s = std::chrono::duration<double>(now - start_).count(),
                        .joules = use->joules,
                        .frames = frames});
  }

  [[nodiscard]] std::optional<EnergyUse> use() const { return meter_.so_far(); }
  /// None if a reading was not valid.
  [[nodiscard]] const std::vector<EnergySample>& samples() const { return samples_; }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  EnergyMeter meter_;
  std::vector<EnergySample> samples_;
};

/// Sampling thread times and energy disturbs the run. The times of threads that end with the run lack its
/// last frames, at most this many.
constexpr std::int64_t kFramesBetweenSamples = 10;

RunSpec spec_of(const ProfileArguments& arguments) {
  const ConfigRequest request{arguments.base, arguments.variant, arguments.settings};
  for (const std::string& message : settings_without_effect(request)) spdlog::warn("{}", message);
  return {.config = load_config(request),
          .mode = arguments.mode,
          .speed = arguments.speed,
          .max_frames = static_cast<std::size_t>(arguments.max_frames),
          .keep_spans = true};
}

/// @param idle_w power before the run
Profile measure(const datasets::SensorStream& stream, const ProfileArguments& arguments,
                const std::optional<double>& idle_w) {
  ProgressLine progress(stream.info().name, stream.info().frame_times.size(), "frames");
  AllocationWatch allocations;
  ThreadUsageSampler thread_usage;
  EnergyWatch energy(arguments);
  const HardwareCounters counters;
  const ProcessUsage before = process_usage();
  const MachineLoad load_before = machine_load();
  const auto on_frame = [&](const FrameReport& report) {
    allocations.end_frame();
    progress.update(static_cast<std::size_t>(report.update.frame_id) + 1);
    if (report.update.frame_id % kFramesBetweenSamples == 0) {
      thread_usage.sample();
      energy.sample(report.update.frame_id + 1);
    }
    allocations.begin_frame();
  };
  Profile profile{.run = run_odometry(stream, spec_of(arguments),
                                      {.on_frame = {on_frame}, .stop_requested = interrupt_requested})};
  profile.usage = usage_between(before, process_usage());
  for (const Metric& metric :
       load_metrics(load_before, machine_load(), profile.usage.user_s + profile.usage.system_s)) {
    if (metric.name == metric_id::kOtherLoad) profile.other_load = metric.value;
  }
  profile.counters = counters.counts();
  profile.counters_missing = counters.reason();
  energy.sample(static_cast<std::int64_t>(profile.run.summary.frames));
  profile.energy = energy.use();
  profile.idle_w = idle_w;
  if (idle_w) profile.energy_above_idle = energy_score(energy.samples(), *idle_w);
  thread_usage.sample();
  profile.threads = thread_usage.usages();
  profile.rows = profile_rows(profile.run.timings, arguments.budget_ms);
  profile.misses = deadline_misses(profile.run.frame_timings, arguments.budget_ms);
  profile.allocations = allocations.counts();
  profile.recorder = recorder_cost(profile.run);
  return profile;
}

/// Repeats the run for --duration. @return the last repetition, with the drift over all
Profile measure_drift(const datasets::SensorStream& stream, const ProfileArguments& arguments,
                      const std::optional<double>& idle_w) {
  const double duration_s = parse_duration_s(arguments.duration, "--duration");
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  std::vector<DriftRow> drift;
  while (true) {
    const ThrottleState before = read_throttle_state(arguments.sysfs_root);
    Profile profile = measure(stream, arguments, idle_w);
    const double t_s = std::chrono::duration<double>(Clock::now() - start).count();
    drift.push_back({.t_s = t_s,
                     .frame_ms = profile.misses.whole_frame ? profile.misses.whole_frame->mean : 0.0,
                     .temperature_c = hottest_celsius(arguments.sysfs_root),
                     .throttled = throttled_between(before, read_throttle_state(arguments.sysfs_root))});
    if (t_s < duration_s && !interrupt_requested()) continue;
    profile.drift = std::move(drift);
    return profile;
  }
}

/// Default number of frames with --instructions: about one minute.
constexpr int kFramesUnderCallgrind = 30;

InstructionRequest instruction_request(const datasets::SequenceInfo& info, const ProfileArguments& arguments,
                                       const fs::path& folder) {
  if (arguments.mode != "sequential") {
    throw InputError("--instructions",
                     "requires the sequential mode, whose counts are reproducible; remove --mode");
  }
  const int max_frames = arguments.max_frames > 0 ? arguments.max_frames : kFramesUnderCallgrind;
  return {.sequence = info.folder,
          .name = info.name,
          .config = {arguments.base, arguments.variant, arguments.settings},
          .frames = std::min(max_frames, static_cast<int>(info.frame_times.size())),
          .folder = folder};
}

DeviceRequest device_request(const ProfileArguments& arguments, const fs::path& folder) {
  if (arguments.mode != "sequential" || arguments.instructions) {
    throw InputError("--device", "uses a virtual clock; remove --mode and --instructions");
  }
  return {.device = arguments.device,
          .config = arguments.base,
          .spec = spec_of(arguments),
          .budget_ms = arguments.budget_ms,
          .folder = folder};
}

/// @throws InputError for options that are invalid whatever the sequence is
void require_valid(const ProfileArguments& arguments) {
  if (!arguments.duration.empty()) static_cast<void>(parse_duration_s(arguments.duration, "--duration"));
  if (arguments.tegrastats.empty()) return;
  require_regular_file(arguments.tegrastats);
  if (!std::ifstream(arguments.tegrastats))
    throw InputError(arguments.tegrastats,
                     "cannot be read; first start `tegrastats --logfile` with this file");
  require_tegrastats(arguments.tegrastats);
}

int run_profile(const ProfileArguments& arguments) {
  require_valid(arguments);
  if (!arguments.cores.empty()) pin_to(parse_cpu_list(arguments.cores));
  install_interrupt_handlers();
  const auto stream = find_sequence(resolve_sequence(arguments.sequence),
                                    {.format = arguments.format, .rig_file = arguments.rig},
                                    {.progress = {}, .stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  const std::string& name = stream->info().name;
  const fs::path folder = arguments.out.empty() ? fs::path("build/profile") / name : fs::path(arguments.out);
  require_safe_folder(folder, profile_layout(), {stream->info().folder, arguments.rig, arguments.tegrastats});
  require_writable(folder);
  if (!arguments.device.empty()) {
    return profile_on_device(*stream, device_request(arguments, folder));
  }
  if (arguments.instructions) {
    return profile_instructions(instruction_request(stream->info(), arguments, folder));
  }
  const std::optional<double> idle_w = idle_power_w(arguments.sysfs_root, arguments.tegrastats);
  const Profile profile = arguments.duration.empty() ? measure(*stream, arguments, idle_w)
                                                     : measure_drift(*stream, arguments, idle_w);
  if (interrupt_requested()) return kExitInterrupted;
  const ProfileTitle title{.sequence = name,
                           .base = arguments.base,
                           .variant = arguments.variant,
                           .mode = arguments.mode,
                           .cores = arguments.cores};
  write_profile(folder, {{"profile.json", profile_text(profile, title) + "\n"},
                         {"trace.json", chrome_trace(profile.run.spans, "stillpoint " + name)},
                         {"stacks.folded", folded_stacks(profile.run.spans)}});
  print_profile(profile);
  std::cout << drift_text(profile.drift);
  std::cout << fmt::format("{} (open trace.json in ui.perfetto.dev)\n", folder.string());
  return kExitOk;
}

std::vector<Option> profile_options(const std::shared_ptr<ProfileArguments>& arguments) {
  return {
      {"SEQ", "Sequence folder or preset name", &arguments->sequence},
      {"--config", "Base config: an embedded name or a TOML file", &arguments->base},
      {"--variant", "Overlays joined by +", &arguments->variant},
      {"--set", "Override a config key: key=value; may be repeated", &arguments->settings},
      {"--mode", "Execution mode: sequential, pipelined or realtime", &arguments->mode},
      {"--frame-budget-ms",
       "Frames that take longer are counted as deadline misses [ms]",
       &arguments->budget_ms,
       {1e-3, 1e6}},
      {"--cores", "CPU affinity, e.g. 0,1 [all]", &arguments->cores},
      {"--out", "Output folder of profile.json, trace.json and stacks.folded [build/profile/SEQ]",
       &arguments->out},
      {"--format", "Sequence format [detected]", &arguments->format},
      {"--rig", kRigHelp, &arguments->rig},
      {"--max-frames",
       "Maximum number of frames; 0 = all, or 30 with --instructions",
       &arguments->max_frames,
       {0, 1e9}},
      {"--device",
       "Simulate this target device on a virtual clock: dropped frames, latency, accuracy; a TOML file or " +
           fmt::format("{}", fmt::join(embedded_names(TomlKind::kDevice), ", ")),
       &arguments->device},
      {"--speed",
       "Playback speed in realtime mode and with --device; 1 = as recorded",
       &arguments->speed,
       {1e-3, 1e3}},
      {"--tegrastats", "Log file of a running tegrastats, for the energy of Jetson devices",
       &arguments->tegrastats},
      {"--duration", "Repeat the run for this time, e.g. 10m, and show the drift of time and temperature",
       &arguments->duration},
      {"--sysfs-root", kSysfsRootHelp, &arguments->sysfs_root},
      {"--instructions", "Count instructions with callgrind instead of measuring times",
       &arguments->instructions}};
}

}  // namespace

Command profile_command() {
  const auto arguments = std::make_shared<ProfileArguments>();
  return {.name = "profile",
          .summary = "Profile one run: table of stage times, timeline, folded stacks",
          .example = "profile market --frame-budget-ms 33 --out /tmp/profile",
          .options = profile_options(arguments),
          .action = [arguments] { return run_profile(*arguments); }};
}

}  // namespace stillpoint::bench
