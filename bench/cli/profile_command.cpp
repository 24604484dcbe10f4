// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/profile_board.h"
#include "bench/cli/profile_instructions.h"
#include "bench/cli/profile_report.h"
#include "bench/cli/progress.h"
#include "bench/config/config_file.h"
#include "bench/plan/bench_plan.h"
#include "bench/profile/process_usage.h"
#include "bench/profile/profile_table.h"
#include "bench/profile/timeline.h"
#include "bench/record/output_folder.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

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
  bool instructions = false;
  std::string board;
  double speed = 1.0;
  std::string tegrastats;
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

RunSpec spec_of(const ProfileArguments& arguments) {
  return {.config = load_config({arguments.base, arguments.variant, arguments.settings}),
          .mode = arguments.mode,
          .speed = arguments.speed,
          .max_frames = static_cast<std::size_t>(arguments.max_frames),
          .keep_spans = true};
}

Profile measure(const SensorStream& stream, const ProfileArguments& arguments) {
  ProgressLine progress(stream.info().name, stream.info().frame_times.size(), "frames");
  AllocationWatch allocations;
  ThreadWatch watch;
  EnergyMeter energy("/", arguments.tegrastats, std::chrono::steady_clock::now());
  const HardwareCounters counters;
  const ProcessUsage before = process_usage();
  const auto on_update = [&](const OdometryUpdate& update) {
    allocations.end_picture();
    progress.update(static_cast<std::size_t>(update.frame_id) + 1);
    if (update.frame_id % kFramesBetweenLooks == 0) {
      watch.look();
      energy.look(std::chrono::steady_clock::now());
    }
    allocations.begin_picture();
  };
  Profile profile{
      .run = run_odometry(stream, spec_of(arguments),
                          {.on_update = on_update, .on_picture = {}, .stop_requested = interrupt_requested})};
  profile.usage = usage_between(before, process_usage());
  profile.counters = counters.counts();
  profile.counters_missing = counters.reason();
  profile.energy = energy.use(std::chrono::steady_clock::now());
  watch.look();
  profile.threads = watch.usages();
  profile.rows = profile_rows(profile.run.timings, arguments.budget_ms);
  profile.misses = deadline_misses(profile.run.frame_timings, arguments.budget_ms);
  profile.allocations = allocations.counts();
  profile.recorder = recorder_cost(profile.run);
  return profile;
}

/// Unless told otherwise: a minute's work.
constexpr int kFramesUnderCallgrind = 30;

InstructionRequest instruction_request(const SequenceInfo& info, const ProfileArguments& arguments,
                                       const fs::path& folder) {
  if (arguments.mode != "sequential") {
    throw InputError("--instructions", "counts one thread, where each run is the same: leave out --mode");
  }
  const int wanted = arguments.max_frames > 0 ? arguments.max_frames : kFramesUnderCallgrind;
  return {.sequence = info.folder,
          .name = info.name,
          .config = {arguments.base, arguments.variant, arguments.settings},
          .frames = std::min(wanted, static_cast<int>(info.frame_times.size())),
          .folder = folder};
}

BoardRequest board_request(const ProfileArguments& arguments, const fs::path& folder) {
  if (arguments.mode != "sequential" || arguments.instructions) {
    throw InputError("--board", "has a clock of its own: leave out --mode and --instructions");
  }
  return {.board = arguments.board,
          .spec = spec_of(arguments),
          .budget_ms = arguments.budget_ms,
          .folder = folder};
}

int run_profile(const ProfileArguments& arguments) {
  if (arguments.max_frames < 0) throw InputError("--max-frames", "must not be negative; 0 means all");
  if (!(arguments.budget_ms > 0.0)) throw InputError("--frame-budget-ms", "must be above 0, e.g. 33");
  if (!arguments.tegrastats.empty() && !fs::exists(arguments.tegrastats)) {
    throw InputError(arguments.tegrastats, "is not there; start `tegrastats --logfile` with this file first");
  }
  if (!arguments.cores.empty()) pin_to(processors_of(arguments.cores));
  watch_interrupts();
  const auto stream =
      find_sequence(arguments.sequence, {.format = arguments.format, .rig_file = arguments.rig},
                    {.progress = {}, .stop_requested = interrupt_requested});
  if (!stream) return kExitInterrupted;
  const std::string& name = stream->info().name;
  const fs::path folder = arguments.out.empty() ? fs::path("build/profile") / name : fs::path(arguments.out);
  require_writable(folder);
  if (!arguments.board.empty()) {
    return profile_on_board(*stream, board_request(arguments, folder));
  }
  if (arguments.instructions) {
    return profile_instructions(instruction_request(stream->info(), arguments, folder));
  }
  const Profile profile = measure(*stream, arguments);
  if (interrupt_requested()) return kExitInterrupted;
  const ProfileTitle title{.sequence = name,
                           .base = arguments.base,
                           .variant = arguments.variant,
                           .mode = arguments.mode,
                           .cores = arguments.cores};
  write_files(folder, {{"profile.json", profile_text(profile, title) + "\n"},
                       {"trace.json", chrome_trace(profile.run.spans, "stillpoint " + name)},
                       {"stacks.folded", folded_stacks(profile.run.spans)}});
  print_profile(profile);
  std::cout << fmt::format("{} (open trace.json in ui.perfetto.dev)\n", folder.string());
  return kExitOk;
}

}  // namespace

Command profile_command() {
  const auto arguments = std::make_shared<ProfileArguments>();
  return {.name = "profile",
          .summary = "Say where the time of one run goes: table, timeline, stacks",
          .example = "profile market --frame-budget-ms 33 --out /tmp/profile",
          .options =
              {{"SEQ", "Sequence folder, or the name of a rendered one", &arguments->sequence},
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
               {"--max-frames", "Stop after this many pictures; 0 = all, or 30 with --instructions",
                &arguments->max_frames},
               {"--board", "Run on the virtual clock of this board: drops, latency, accuracy (name or file)",
                &arguments->board},
               {"--speed", "Of the clock in realtime mode and of boards; 1 = as recorded", &arguments->speed},
               {"--tegrastats", "Log that tegrastats writes meanwhile: energy of Jetson boards",
                &arguments->tegrastats},
               {"--instructions", "Count instructions under valgrind's callgrind instead of time",
                &arguments->instructions}},
          .action = [arguments] { return run_profile(*arguments); },
          .subcommands = {}};
}

}  // namespace stillpoint
