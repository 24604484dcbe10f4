// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/config/config_file.h"
#include "bench/plan/bench_plan.h"
#include "bench/profile/process_usage.h"
#include "bench/profile/profile_table.h"
#include "bench/profile/timeline.h"
#include "bench/record/output_folder.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "reports/text_table.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What the command line of `profile` says.
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
};

/// One run with all that was measured.
struct Profile {
  OdometryRun run;
  std::vector<ProfileRow> rows;
  DeadlineMisses misses;
  ProcessUsage usage;
  std::map<int, ThreadUsage> threads;
};

/// The times of threads while they live: those of a run end with it.
class ThreadWatch {
 public:
  void look() {
    for (auto& [id, usage] : thread_usages()) threads_[id] = usage;
  }
  /// Since the watch began.
  [[nodiscard]] std::map<int, ThreadUsage> usages() const {
    std::map<int, ThreadUsage> own = threads_;
    for (const auto& [id, usage] : before_) {
      own[id].user_s -= usage.user_s;
      own[id].system_s -= usage.system_s;
    }
    return own;
  }

 private:
  std::map<int, ThreadUsage> before_ = thread_usages();
  std::map<int, ThreadUsage> threads_ = before_;
};

/// Looking costs time that would be the run's. Threads that end with a run are seen up to that many pictures
/// before.
constexpr std::int64_t kFramesBetweenLooks = 10;

Profile measure(const SensorStream& stream, const ProfileArguments& arguments) {
  ProgressLine progress(stream.info().name, stream.info().frame_times.size(), "frames");
  ThreadWatch watch;
  const ProcessUsage before = process_usage();
  const auto on_update = [&](const OdometryUpdate& update) {
    progress.update(static_cast<std::size_t>(update.frame_id) + 1);
    if (update.frame_id % kFramesBetweenLooks == 0) watch.look();
  };
  const RunSpec spec{.config = load_config({arguments.base, arguments.variant, arguments.settings}),
                     .mode = arguments.mode,
                     .max_frames = static_cast<std::size_t>(arguments.max_frames),
                     .keep_spans = true};
  OdometryRun run = run_odometry(
      stream, spec, {.on_update = on_update, .on_picture = {}, .stop_requested = interrupt_requested});
  const ProcessUsage usage = usage_between(before, process_usage());
  watch.look();
  std::vector<ProfileRow> rows = profile_rows(run.timings, arguments.budget_ms);
  const DeadlineMisses misses = deadline_misses(run.frame_timings, arguments.budget_ms);
  return {.run = std::move(run),
          .rows = std::move(rows),
          .misses = misses,
          .usage = usage,
          .threads = watch.usages()};
}

Json json_of(const Profile& profile, const ProfileArguments& arguments, const std::string& sequence) {
  Json json = {{"sequence", sequence},   {"base", arguments.base},   {"variant", arguments.variant},
               {"mode", arguments.mode}, {"cores", arguments.cores}, {"wall_s", profile.run.wall_s}};
  json.update(profile_json(profile.rows, profile.misses));
  json["process"] = usage_json(profile.usage, profile.threads);
  return json;
}

std::string ms(double value) { return fmt::format("{:.3f}", value); }

void print_table(const std::vector<ProfileRow>& rows, const DeadlineMisses& misses) {
  TableRows table = {{"ms", "per", "mean", "median", "p95", "p99", "max", "times", "frames beyond budget"}};
  const auto add = [&](std::string_view name, const char* per, const TimingStatistics& time,
                       std::int64_t beyond) {
    table.push_back({std::string(name), per, ms(time.mean), ms(time.median), ms(time.p95), ms(time.p99),
                     ms(time.max), fmt::format("{}", time.calls), fmt::format("{}", beyond)});
  };
  for (const ProfileRow& row : rows) {
    const std::string_view name = module_name(row.module);
    if (!is_thread(row.module)) add(name, "call", row.per_call, row.frames_beyond);
    add(name, "frame", row.per_frame, row.frames_beyond);
  }
  if (misses.whole_frame) add("all_stages", "frame", *misses.whole_frame, misses.one_thread);
  std::cout << format_table(table, TableStyle::kText);
}

void print(const Profile& profile) {
  print_table(profile.rows, profile.misses);
  std::cout << fmt::format(
      "{} frames in {:.2f} s; longer than {:g} ms: {} on one thread, {} with a thread for each stage\n",
      profile.misses.frames, profile.run.wall_s, profile.misses.budget_ms, profile.misses.one_thread,
      profile.misses.thread_per_stage);
  const ProcessUsage& usage = profile.usage;
  std::cout << fmt::format(
      "processor {:.2f} s + {:.2f} s system, {} waits, {} preemptions, {} + {} page faults, peak {:.0f} MB\n",
      usage.user_s, usage.system_s, usage.waits, usage.preemptions, usage.minor_faults, usage.major_faults,
      1e-6 * static_cast<double>(usage.peak_memory_bytes));
  for (const auto& [id, thread] : profile.threads) {
    std::cout << fmt::format("  thread {} {}: {:.2f} s + {:.2f} s system\n", id, thread.name, thread.user_s,
                             thread.system_s);
  }
}

int run_profile(const ProfileArguments& arguments) {
  if (arguments.max_frames < 0) throw InputError("--max-frames", "must not be negative; 0 means all");
  if (!(arguments.budget_ms > 0.0)) throw InputError("--frame-budget-ms", "must be above 0, e.g. 33");
  if (!arguments.cores.empty()) pin_to(processors_of(arguments.cores));
  watch_interrupts();
  const auto stream =
      find_sequence(arguments.sequence, {.format = arguments.format, .rig_file = arguments.rig},
                    {.progress = {}, .stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  const std::string& name = stream->info().name;
  const fs::path folder = arguments.out.empty() ? fs::path("build/profile") / name : fs::path(arguments.out);
  require_writable(folder);
  const Profile profile = measure(*stream, arguments);
  if (interrupt_requested()) return kExitInterrupted;
  write_files(folder, {{"profile.json", json_of(profile, arguments, name).dump(2) + "\n"},
                       {"trace.json", chrome_trace(profile.run.spans, "stillpoint " + name)},
                       {"stacks.folded", folded_stacks(profile.run.spans)}});
  print(profile);
  std::cout << fmt::format("{} (open trace.json in ui.perfetto.dev)\n", folder.string());
  return kExitOk;
}

}  // namespace

Command profile_command() {
  const auto arguments = std::make_shared<ProfileArguments>();
  return {
      .name = "profile",
      .summary = "Say where the time of one run goes: table, timeline, stacks",
      .example = "profile market --frame-budget-ms 33 --out /tmp/profile",
      .options = {{"SEQ", "Sequence folder, or the name of a rendered one", &arguments->sequence},
                  {"--config", "Base config: an embedded name or a TOML file", &arguments->base},
                  {"--variant", "Overlays joined by +", &arguments->variant},
                  {"--set", "Change one key: key=value, may be repeated", &arguments->settings},
                  {"--mode", "How the stages are run: sequential, pipelined or realtime", &arguments->mode},
                  {"--frame-budget-ms", "Frames that take longer are counted", &arguments->budget_ms},
                  {"--cores", "Processors it may use, e.g. 0,1 [all]", &arguments->cores},
                  {"--out", "Folder for profile.json, trace.json, stacks.folded [build/profile/SEQ]",
                   &arguments->out},
                  {"--format", "Layout of the folder [recognised]", &arguments->format},
                  {"--rig", "A rig.toml that overrides the sequence's calibration", &arguments->rig},
                  {"--max-frames", "Stop after this many pictures; 0 = all", &arguments->max_frames}},
      .action = [arguments] { return run_profile(*arguments); },
      .subcommands = {}};
}

}  // namespace stillpoint
