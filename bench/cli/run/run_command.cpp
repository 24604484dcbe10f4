// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/cli/run/open_with_progress.h"
#include "bench/config/config_file.h"
#include "bench/model/metrics.h"
#include "bench/model/utc_time.h"
#include "bench/record/label_dump.h"
#include "bench/record/output_folder.h"
#include "bench/record/remembered_checksum.h"
#include "bench/record/run_files.h"
#include "bench/run/frame_cache_settings.h"
#include "bench/run/heartbeat.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"
#include "datasets/ping_pong_playback.h"
#include "reports/drawing/cost_trend.h"
#include "reports/drawing/drawing.h"
#include "reports/frames/run_video.h"
#include "reports/frames/worst_frames.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// Command line arguments of `run`.
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
  bool deterministic_counts = false;
  bool no_frame_cache = false;
  double speed = 1.0;
  std::vector<std::string> dumps;
  int passes = 1;
  std::string video;
  int images = 0;
};

/// A run to execute; one for each --variant.
struct ConfiguredRun {
  std::string variant;
  RunSpec spec;
  fs::path folder;
  fs::path video;  ///< folder of annotated frames; empty = none
};

/// Loads all configs before the first run starts, so that errors are reported early.
std::vector<ConfiguredRun> plan_runs(const RunArguments& arguments) {
  std::vector<std::string> variants = arguments.variants;
  if (variants.empty()) variants.emplace_back();
  std::vector<ConfiguredRun> runs;
  for (const std::string& variant : variants) {
    runs.push_back({.variant = variant.empty() ? arguments.base : variant,
                    .spec = {.config = load_config({arguments.base, variant, arguments.settings}),
                             .mode = arguments.mode,
                             .speed = arguments.speed,
                             .max_frames = static_cast<std::size_t>(arguments.max_frames),
                             .decode_color = !arguments.video.empty(),
                             .keep_spans = true,
                             .deterministic_counts = arguments.deterministic_counts},
                    .folder = {},
                    .video = arguments.video});
  }
  return runs;
}

/// Sets the output folder of each run: --out for a single run, else a subfolder. Checks that it is writable.
std::vector<ConfiguredRun> with_folders(std::vector<ConfiguredRun> runs, const std::string& out,
                                        const std::string& sequence) {
  const fs::path root = out.empty() ? fs::path("build/runs") / sequence : fs::path(out);
  const bool shared_root = out.empty() || runs.size() > 1;
  for (ConfiguredRun& run : runs) {
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
  if (update.counters.reset) spdlog::warn("frame {}: tracking failed, estimator reset", update.frame_id);
}

/// The video requested by --video.
std::optional<report::RunVideo> start_video(const datasets::SequenceInfo& info,
                                            const ConfiguredRun& configured) {
  if (configured.video.empty()) return std::nullopt;
  return std::optional<report::RunVideo>(std::in_place, configured.video,
                                         report::annotation_style(configured.spec.config.frontend),
                                         report::mean_rate_hz(info.frame_times));
}

/// The annotated frames requested by --images.
std::optional<report::WorstFrames> start_worst_frames(const datasets::SequenceInfo& info,
                                                      const RunArguments& arguments,
                                                      const ConfiguredRun& configured) {
  if (arguments.images == 0) return std::nullopt;
  return std::optional<report::WorstFrames>(std::in_place, configured.folder / "images",
                                            static_cast<std::size_t>(arguments.images),
                                            report::annotation_style(configured.spec.config.frontend), info);
}

bool is_requested(const RunArguments& arguments, const std::string& dump) {
  return std::ranges::find(arguments.dumps, dump) != arguments.dumps.end();
}

/// Result and additional output files of a run.
struct Executed {
  RunResult result;
  std::vector<OutputFile> dumps;
};

Executed execute(const datasets::SensorStream& stream, const RunArguments& arguments,
                 const ConfiguredRun& configured) {
  const std::size_t total = stream.info().frame_times.size();
  const std::optional<Heartbeat> heartbeat =
      arguments.heartbeat.empty() ? std::nullopt : std::make_optional<Heartbeat>(arguments.heartbeat);
  ProgressLine progress(stream.info().name + " " + configured.variant, total, "frames");
  const auto on_update = [&](const OdometryUpdate& update) {
    log_update(update);
    if (heartbeat) heartbeat->beat(update.frame_id);
    progress.update(static_cast<std::size_t>(update.frame_id) + 1);
  };
  LabelDump labels;
  RunControl control{.on_update = on_update, .on_frame = {}, .stop_requested = interrupt_requested};
  const bool dump_labels = is_requested(arguments, "labels");
  std::optional<report::RunVideo> video = start_video(stream.info(), configured);
  std::optional<report::WorstFrames> worst_frames = start_worst_frames(stream.info(), arguments, configured);
  if (dump_labels || video || worst_frames) {
    control.on_frame = [&](const FrameReport& report) {
      if (dump_labels) labels.add(report);
      if (video) video->add(report);
      if (worst_frames) worst_frames->add(report);
    };
  }
  Executed run{.result = score_run(stream.info(), run_odometry(stream, configured.spec, control)),
               .dumps = {}};
  run.result.variant = configured.variant;
  run.result.mode = configured.spec.mode;
  if (video) video->finish();
  if (dump_labels) run.dumps.push_back({"labels.csv", labels.text()});
  if (is_requested(arguments, "cost") && !interrupt_requested()) {
    const report::CostTrend trend = report::cost_trend(report::frame_costs(run.result.run));
    run.dumps.push_back({"cost.svg", report::svg_text(report::cost_plot(trend))});
  }
  return run;
}

/// --sequence-id, or the checksum of the sequence.
std::string id_of(const datasets::SequenceInfo& info, const RunArguments& arguments) {
  if (interrupt_requested()) return "";
  return arguments.sequence_id.empty() ? remembered_checksum(info.folder, checksum_folder())
                                       : arguments.sequence_id;
}

RunManifest manifest_of(const datasets::SequenceInfo& info, const RunArguments& arguments,
                        const ConfiguredRun& configured) {
  return {.sequence = info.name,
          .sequence_format = info.format,
          .sequence_checksum = id_of(info, arguments),
          .base = arguments.base,
          .variant = configured.variant,
          .config = configured.spec.config,
          .mode = configured.spec.mode,
          .build = build_info(),
          .host = host_info(),
          .started = utc_now()};
}

/// "ATE 0.0123 m, ..., first pose n/a".
std::string score_line(const RunResult& result) {
  const Measurements measurements = measurements_of(result);
  std::vector<std::string> parts;
  for (const MetricDescriptor* metric : metrics_of(MetricSource::kTrajectory)) {
    const std::optional<double> value = metric->value(measurements);
    parts.push_back(value ? value_text(*metric, *value) : fmt::format("{} n/a", metric->label));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

void print_result(const RunResult& result, const fs::path& folder) {
  for (const SkippedFrame& frame : result.run.summary.skipped) {
    spdlog::warn("frame {} skipped: {}", frame.index, frame.reason);
  }
  if (!result.failure.empty()) spdlog::warn("{}", result.failure);
  std::cout << fmt::format("{} {}: {}, {} of {} frames, {}\n  {}\n", result.sequence, result.variant,
                           status_name(result.outcome), result.run.summary.frames, result.run.frames_planned,
                           score_line(result), (folder / "result.json").string());
}

int exit_code(Outcome outcome) {
  if (outcome == Outcome::kInterrupted) return kExitInterrupted;
  return outcome == Outcome::kLost ? kExitFindings : kExitOk;
}

/// Opens the sequence; renders it first if necessary. @return null if interrupted
std::unique_ptr<datasets::SensorStream> open(const RunArguments& arguments,
                                             const std::vector<ConfiguredRun>& runs) {
  // Instruction counts must not depend on earlier runs; several passes use all frames.
  const bool cached = !arguments.no_frame_cache && !arguments.deterministic_counts;
  const int frames = arguments.passes == 1 ? arguments.max_frames : 0;
  auto stream = open_with_progress(
      arguments.sequence, {.format = arguments.format,
                           .rig_file = arguments.rig,
                           .defer_color = std::ranges::none_of(runs, needs_color, &ConfiguredRun::spec),
                           .frame_cache = logged_frame_cache(cached, frames)});
  const bool single_pass = !stream || arguments.passes == 1;
  return single_pass ? std::move(stream) : datasets::ping_pong_playback(std::move(stream), arguments.passes);
}

int run(const RunArguments& arguments) {
  if (arguments.max_frames < 0) throw InputError("--max-frames", "must not be negative; 0 means all");
  if (arguments.images < 0) throw InputError("--images", "must not be negative; 0 means none");
  for (const std::string& dump : arguments.dumps) {
    if (dump == "labels" || dump == "cost") continue;
    throw InputError("--dump", "unknown value \"" + dump + "\"; expected one of: labels, cost");
  }
  install_interrupt_handlers();
  const std::vector<ConfiguredRun> runs = plan_runs(arguments);
  const std::unique_ptr<datasets::SensorStream> stream = open(arguments, runs);
  if (!stream) return kExitInterrupted;
  for (const std::string& note : stream->info().notes) spdlog::info("{}", note);
  int code = kExitOk;
  for (const ConfiguredRun& configured : with_folders(runs, arguments.out, stream->info().name)) {
    if (interrupt_requested()) return kExitInterrupted;
    Executed run = execute(*stream, arguments, configured);
    write_run(configured.folder, run.result, manifest_of(stream->info(), arguments, configured),
              std::move(run.dumps));
    print_result(run.result, configured.folder);
    code = std::max(code, exit_code(run.result.outcome));
  }
  return code;
}

}  // namespace

Command run_command() {
  const auto arguments = std::make_shared<RunArguments>();
  return {
      .name = "run",
      .summary = "Run the odometry on one sequence; write trajectory, scores and manifest",
      .example = "run walking_xyz --variant wo_circular_mask --out /tmp/run",
      .options =
          {{"SEQ", "Sequence folder or preset name", &arguments->sequence},
           {"--config", "Base config: an embedded name or a TOML file", &arguments->base},
           {"--variant", "Overlays joined by +; may be repeated, each --variant is a separate run",
            &arguments->variants},
           {"--set", "Override a config key: key=value; may be repeated", &arguments->settings},
           {"--mode", "Execution mode: sequential, pipelined or realtime", &arguments->mode},
           {"--speed", "Playback speed in realtime mode; 1 = as recorded", &arguments->speed},
           {"--out", "Output folder [build/runs/SEQ/VARIANT]", &arguments->out},
           {"--format", "Sequence format: " + datasets::sequence_format_names() + " [detected]",
            &arguments->format},
           {"--rig", "rig.toml that overrides the calibration of the sequence", &arguments->rig},
           {"--dump",
            "Additional output: labels (labels.csv, dynamic labels of all features) or cost (cost.svg, "
            "processing time of each frame); may be repeated",
            &arguments->dumps},
           {"--passes", "Number of passes, alternately forward and backward, without IMU data [1]",
            &arguments->passes},
           {"--video", "Write annotated frames and video.mp4 into this folder", &arguments->video},
           {"--images", "Number of frames with the largest error growth to write as annotated images [0]",
            &arguments->images},
           {"--sequence-id",
            "Identifier for the manifest, instead of a checksum over all files of the sequence",
            &arguments->sequence_id},
           {"--heartbeat", "File that receives the id of the last processed frame", &arguments->heartbeat},
           {"--max-frames", "Maximum number of frames; 0 = all", &arguments->max_frames},
           {"--no-frame-cache", "Decode all images again, and do not keep them", &arguments->no_frame_cache},
           {"--deterministic-counts", "One thread with a separate heap, for reproducible instruction counts",
            &arguments->deterministic_counts}},
      .action = [arguments] { return run(*arguments); }};
}

}  // namespace stillpoint::bench
