// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/config/config_file.h"
#include "bench/record/output_folder.h"
#include "bench/record/run_files.h"
#include "bench/record/sequence_checksum.h"
#include "bench/record/utc_time.h"
#include "bench/record/verdict_dump.h"
#include "bench/run/heartbeat.h"
#include "bench/run/sequence_source.h"
#include "core/base/error.h"
#include "datasets/to_and_fro.h"
#include "reports/cost_trend.h"
#include "reports/run_video.h"
#include "reports/svg_drawing.h"
#include "reports/worst_pictures.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

/// What the command line of `run` says.
struct RunArguments {
  std::string sequence;
  std::string base = "stillpoint";
  std::vector<std::string> variants;
  std::vector<std::string> settings;
  std::string mode = "sequential";
  std::string out;
  std::string format;
  std::string rig;
  std::string heartbeat;
  std::string sequence_id;
  int max_frames = 0;
  bool countable = false;
  double speed = 1.0;
  std::vector<std::string> dumps;
  int passes = 1;
  std::string video;
  int pictures = 0;
};

/// One run of possibly several.
struct PlannedRun {
  std::string variant;
  RunSpec spec;
  fs::path folder;
  fs::path video;  ///< folder of annotated pictures; empty = none
};

/// Reads every config, so that a fault in the last one ends the program before the first run.
std::vector<PlannedRun> plan_runs(const RunArguments& arguments) {
  std::vector<std::string> variants = arguments.variants;
  if (variants.empty()) variants.emplace_back();
  std::vector<PlannedRun> runs;
  for (const std::string& variant : variants) {
    runs.push_back({.variant = variant.empty() ? arguments.base : variant,
                    .spec = {.config = load_config({arguments.base, variant, arguments.settings}),
                             .mode = arguments.mode,
                             .speed = arguments.speed,
                             .max_frames = static_cast<std::size_t>(arguments.max_frames),
                             .keep_spans = true,
                             .countable = arguments.countable},
                    .folder = {},
                    .video = arguments.video});
  }
  return runs;
}

/// Chooses and tries each run's folder: --out itself for a single run, else one below it for each.
std::vector<PlannedRun> with_folders(std::vector<PlannedRun> runs, const std::string& out,
                                     const std::string& sequence) {
  const fs::path root = out.empty() ? fs::path("build/runs") / sequence : fs::path(out);
  const bool shared_root = out.empty() || runs.size() > 1;
  for (PlannedRun& run : runs) {
    if (!run.video.empty() && runs.size() > 1) run.video /= folder_name(run.variant);
    run.folder = shared_root ? root / folder_name(run.variant) : root;
    require_writable(run.folder);
  }
  return runs;
}

void log_update(const OdometryUpdate& update) {
  spdlog::debug("frame {}: {} features, {} landmarks, {} iterations{}", update.frame_id,
                update.counters.tracked_features, update.counters.window_landmarks,
                update.counters.solver_iterations, update.counters.keyframe ? ", keyframe" : "");
  if (update.counters.reset)
    spdlog::warn("frame {}: tracking failed, the estimator begins anew", update.frame_id);
}

/// The video that was asked for.
std::optional<RunVideo> start_video(const SequenceInfo& info, const PlannedRun& planned) {
  if (planned.video.empty()) return std::nullopt;
  return std::optional<RunVideo>(std::in_place, planned.video, annotation_style(planned.spec.config.frontend),
                                 mean_rate_hz(info.frame_times));
}

/// The pictures of the worst frames, if they were asked for.
std::optional<WorstPictures> start_pictures(const SequenceInfo& info, const RunArguments& arguments,
                                            const PlannedRun& planned) {
  if (arguments.pictures == 0) return std::nullopt;
  return std::optional<WorstPictures>(std::in_place, planned.folder / "pictures",
                                      static_cast<std::size_t>(arguments.pictures),
                                      annotation_style(planned.spec.config.frontend), info);
}

bool asked_for(const RunArguments& arguments, const std::string& dump) {
  return std::ranges::find(arguments.dumps, dump) != arguments.dumps.end();
}

/// What a run leaves behind.
struct Executed {
  RunResult result;
  std::vector<OutputFile> dumps;
};

Executed execute(const SensorStream& stream, const RunArguments& arguments, const PlannedRun& planned) {
  const std::size_t total = stream.info().frame_times.size();
  const std::optional<Heartbeat> heartbeat =
      arguments.heartbeat.empty() ? std::nullopt : std::make_optional<Heartbeat>(arguments.heartbeat);
  ProgressLine progress(stream.info().name + " " + planned.variant, total, "frames");
  const auto on_update = [&](const OdometryUpdate& update) {
    log_update(update);
    if (heartbeat) heartbeat->beat(update.frame_id);
    progress.update(static_cast<std::size_t>(update.frame_id) + 1);
  };
  VerdictDump verdicts;
  RunControl control{.on_update = on_update, .on_picture = {}, .stop_requested = interrupt_requested};
  const bool dumps = asked_for(arguments, "verdicts");
  std::optional<RunVideo> video = start_video(stream.info(), planned);
  std::optional<WorstPictures> pictures = start_pictures(stream.info(), arguments, planned);
  if (dumps || video || pictures) {
    control.on_picture = [&](const PictureReport& report) {
      if (dumps) verdicts.add(report);
      if (video) video->add(report);
      if (pictures) pictures->add(report);
    };
  }
  Executed run{.result = score_run(stream.info(), run_odometry(stream, planned.spec, control)), .dumps = {}};
  run.result.variant = planned.variant;
  run.result.mode = planned.spec.mode;
  if (video) video->finish();
  if (dumps) run.dumps.push_back({"verdicts.csv", verdicts.text()});
  if (asked_for(arguments, "cost") && !interrupt_requested()) {
    const CostTrend trend = cost_trend(frame_costs(run.result.run));
    run.dumps.push_back({"cost.svg", svg_text(cost_plot(trend))});
  }
  return run;
}

/// What the sequence is known by: as told, or read now.
std::string id_of(const SequenceInfo& info, const RunArguments& arguments) {
  if (interrupt_requested()) return "";
  return arguments.sequence_id.empty() ? sequence_checksum(info.folder) : arguments.sequence_id;
}

RunManifest manifest_of(const SequenceInfo& info, const RunArguments& arguments, const PlannedRun& planned) {
  return {.sequence = info.name,
          .sequence_format = info.format,
          .sequence_checksum = id_of(info, arguments),
          .base = arguments.base,
          .variant = planned.variant,
          .config = planned.spec.config,
          .mode = planned.spec.mode,
          .build = build_info(),
          .host = host_info(),
          .started = utc_now()};
}

std::string text_or_na(const std::optional<double>& value, const char* unit) {
  return value ? fmt::format("{:.4f}{}", *value, unit) : "n/a";
}

void print_result(const RunResult& result, const fs::path& folder) {
  const Score& score = result.score;
  for (const SkippedFrame& frame : result.run.summary.skipped) {
    spdlog::warn("frame {} skipped: {}", frame.index, frame.reason);
  }
  if (!result.failure.empty()) spdlog::warn("{}", result.failure);
  std::cout << fmt::format(
      "{} {}: {}, {} of {} frames, ATE {}, T.RPE {}, R.RPE {}, correct {}, coverage {}, first pose {}\n  "
      "{}\n",
      result.sequence, result.variant, status_name(result.status), result.run.summary.frames,
      result.run.frames_planned, text_or_na(score.ate_rmse_m, " m"),
      text_or_na(score.rpe_trans_rmse_m_per_s, " m/s"), text_or_na(score.rpe_rot_rmse_deg_per_s, " deg/s"),
      text_or_na(score.correct_rate, ""), text_or_na(score.coverage, ""),
      text_or_na(score.first_pose_s, " s"), (folder / "result.json").string());
}

int exit_code(RunStatus status) {
  if (status == RunStatus::kInterrupted) return kExitInterrupted;
  return status == RunStatus::kFailed ? kExitFindings : kExitOk;
}

/// Opens the sequence, rendering it first if need be; nothing after Ctrl-C.
std::unique_ptr<SensorStream> open(const RunArguments& arguments) {
  std::unique_ptr<ProgressLine> progress;
  const auto on_rendered = [&](int done, int total) {
    if (!progress) {
      progress = std::make_unique<ProgressLine>("rendering " + arguments.sequence,
                                                static_cast<std::size_t>(total), "frames");
    }
    progress->update(static_cast<std::size_t>(done));
  };
  auto stream = find_sequence(arguments.sequence, {.format = arguments.format, .rig_file = arguments.rig},
                              {.progress = on_rendered, .stop_requested = interrupt_requested});
  const bool once = !stream || arguments.passes == 1;
  return once ? std::move(stream) : play_to_and_fro(std::move(stream), arguments.passes);
}

int run(const RunArguments& arguments) {
  if (arguments.max_frames < 0) throw InputError("--max-frames", "must not be negative; 0 means all");
  if (arguments.pictures < 0) throw InputError("--pictures", "must not be negative; 0 means none");
  for (const std::string& dump : arguments.dumps) {
    if (dump == "verdicts" || dump == "cost") continue;
    throw InputError("--dump", "\"" + dump + "\" is not known; use \"verdicts\" or \"cost\"");
  }
  watch_interrupts();
  const std::vector<PlannedRun> runs = plan_runs(arguments);
  const std::unique_ptr<SensorStream> stream = open(arguments);
  if (!stream) return kExitInterrupted;
  for (const std::string& note : stream->info().notes) spdlog::info("{}", note);
  int code = kExitOk;
  for (const PlannedRun& planned : with_folders(runs, arguments.out, stream->info().name)) {
    if (interrupt_requested()) return kExitInterrupted;
    Executed run = execute(*stream, arguments, planned);
    write_run(planned.folder, run.result, manifest_of(stream->info(), arguments, planned),
              std::move(run.dumps));
    print_result(run.result, planned.folder);
    code = std::max(code, exit_code(run.result.status));
  }
  return code;
}

}  // namespace

Command run_command() {
  const auto arguments = std::make_shared<RunArguments>();
  return {
      .name = "run",
      .summary = "Run the odometry over one sequence; write trajectory, scores and manifest",
      .example = "run walking_xyz --variant wo_circular_mask --out /tmp/run",
      .options =
          {{"SEQ", "Sequence folder, or the name of a rendered one", &arguments->sequence},
           {"--config", "Base config: an embedded name or a TOML file", &arguments->base},
           {"--variant", "Overlays joined by +; each further --variant is a further run",
            &arguments->variants},
           {"--set", "Change one key: key=value, may be repeated", &arguments->settings},
           {"--mode", "How the stages are run: sequential, pipelined or realtime", &arguments->mode},
           {"--speed", "Of the clock in realtime mode; 1 = as recorded", &arguments->speed},
           {"--out", "Folder for the results [build/runs/SEQ/VARIANT]", &arguments->out},
           {"--format", "Layout of the folder: tum, openloris, euroc, 7scenes, folder [recognised]",
            &arguments->format},
           {"--rig", "A rig.toml that overrides the sequence's calibration", &arguments->rig},
           {"--dump",
            "Also write verdicts.csv, every verdict on every feature, or cost.svg, what frames cost over "
            "time: "
            "verdicts, cost",
            &arguments->dumps},
           {"--passes", "Play it forwards and backwards in turn, so many times, without inertial data [1]",
            &arguments->passes},
           {"--video", "Also write annotated pictures and video.mp4 into this folder", &arguments->video},
           {"--pictures",
            "Also write annotated pictures of this many frames at which the error grew most [0]",
            &arguments->pictures},
           {"--sequence-id",
            "Note this in the manifest instead of a checksum over every file of the sequence",
            &arguments->sequence_id},
           {"--heartbeat", "File that holds the number of the last finished frame", &arguments->heartbeat},
           {"--max-frames", "Stop after this many pictures; 0 = all", &arguments->max_frames},
           {"--countable", "One thread with a heap of its own: instruction counts of two runs are equal",
            &arguments->countable}},
      .action = [arguments] { return run(*arguments); },
      .subcommands = {}};
}

}  // namespace stillpoint
