// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint run`: opens the sequence, executes its runs one after the other, and writes their files.
#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/run/run_dumps.h"
#include "bench/cli/run/sequence_playback.h"
#include "bench/config/config_file.h"
#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"
#include "bench/plan/plan_sequences.h"
#include "bench/profile/meters/process_usage.h"
#include "bench/profile/meters/run_monitor.h"
#include "bench/record/map_file.h"
#include "bench/record/output_folder.h"
#include "bench/record/run_files.h"
#include "bench/run/frame_cache.h"
#include "bench/run/odometry_run.h"
#include "bench/run/rig_report.h"
#include "bench/run/run_indicators.h"
#include "bench/run/run_scores.h"
#include "core/base/error.h"
#include "core/config/odometry_config.h"
#include "datasets/faults/sensor_fault.h"
#include "datasets/open_sequence.h"
#include "datasets/sensor_stream.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

/// The options --map, --save-map and --final-ba.
struct MapOptions {
  std::string load;       ///< map of an earlier run; empty = none
  std::string save;       ///< file for the map of this run; empty = none
  bool final_ba = false;  ///< global bundle adjustment after the last frame
};

OutputRules rules_of(const MapOptions& options) { return {.inputs = {options.load}, .beginning = kMapMagic}; }

/// Checks the options before the work begins.
/// @param runs number of runs of the command
/// @throws InputError without loop closure, for several runs with --save-map, and if the output file must not
/// be replaced
void require_map_options(const MapOptions& options, const OdometryConfig& config, std::size_t runs) {
  if (options.load.empty() && options.save.empty() && !options.final_ba) return;
  if (!config.loop.enabled) {
    const char* const option = !options.load.empty()  ? "--map"
                               : options.save.empty() ? "--final-ba"
                                                      : "--save-map";
    throw InputError(option, "requires loop closure; add --variant ablations/loop_closure");
  }
  if (options.save.empty()) return;
  if (runs > 1) throw InputError("--save-map", "requires a single run; pass one --variant");
  require_safe_output(options.save, rules_of(options));
}

/// The map of --map, or null. @throws InputError as `read_map`
std::shared_ptr<const KeyframeMap> load_map(const MapOptions& options) {
  return options.load.empty() ? nullptr : std::make_shared<KeyframeMap>(read_map(options.load));
}

/// Writes the map of --save-map, if any. With --map it contains the keyframes of both runs.
/// @throws InputError if the run was not located in the map of --map
void save_map(const MapOptions& options, const LoopReport& report) {
  if (options.save.empty()) return;
  if (!report.map) {
    throw InputError("--save-map",
                     "the run was not located in the map of --map, so it cannot extend it; run without --map "
                     "for a map of its own");
  }
  write_output(options.save, map_bytes(*report.map), rules_of(options));
}

struct RunArguments {
  std::string sequence, base = "stillpoint", mode = "sequential";
  std::vector<std::string> variants, settings, faults, topics, dumps;
  std::string out, format, rig, heartbeat, sequence_id, video, mcap, map_cloud, sysfs_root = "/";
  int max_frames = 0, every = 1, passes = 1, images = 0, gray_noise = 0;
  bool deterministic_counts = false, no_frame_cache = false, imu_rate = false, mcap_images = false,
       force = false;
  double speed = 1.0, start_s = 0.0, seconds = 0.0, map_voxel_m = 0.02;
  MapOptions map;
};

struct ConfiguredRun {
  std::string variant;
  RunSpec spec;
  std::vector<datasets::SensorFault> faults;  ///< the same for all runs
  fs::path folder, video;                     ///< of the files, and of annotated frames; empty = none
};

/// Loads all configs and faults before the first run starts, so that errors are reported early.
std::vector<ConfiguredRun> plan_runs(const RunArguments& arguments) {
  std::vector<std::string> variants = arguments.variants;
  if (variants.empty()) variants.emplace_back();
  // Not in the braces below: g++ 12 destroys members of an aggregate twice if an initializer throws.
  const std::vector<datasets::SensorFault> faults = parsed_faults(arguments.faults);
  std::vector<std::string> settings = arguments.settings;
  if (arguments.imu_rate) settings.emplace_back("pipeline.imu_rate=true");
  if (arguments.map.final_ba) settings.emplace_back("loop.final_bundle_adjustment=true");
  const std::shared_ptr<const KeyframeMap> map = load_map(arguments.map);
  std::vector<ConfiguredRun> runs;
  for (const std::string& variant : variants) {
    const ConfigRequest request{arguments.base, variant, settings};
    for (const std::string& message : settings_without_effect(request)) spdlog::warn("{}", message);
    runs.push_back({.variant = variant.empty() ? arguments.base : variant,
                    .spec = {.config = load_config(request),
                             .mode = arguments.mode,
                             .speed = arguments.speed,
                             .map = map,
                             .decode_color = !arguments.video.empty() || arguments.mcap_images ||
                                             !arguments.map_cloud.empty(),
                             .keep_spans = true,
                             .deterministic_counts = arguments.deterministic_counts},
                    .faults = faults,
                    .folder = {},
                    .video = arguments.video});
    require_map_options(arguments.map, runs.back().spec.config, variants.size());
  }
  return runs;
}

/// Checks --mcap and --map-cloud before the work begins.
/// @throws InputError for several runs, and if a file exists
void require_file_options(const RunArguments& arguments, std::size_t runs,
                          const std::vector<fs::path>& inputs) {
  if (arguments.mcap.empty() && arguments.mcap_images)
    throw InputError("--mcap-images", "requires --mcap FILE, the recording that contains the images");
  for (const auto& [option, file] :
       {std::pair("--mcap", arguments.mcap), std::pair("--map-cloud", arguments.map_cloud)}) {
    if (file.empty()) continue;
    if (runs > 1) throw InputError(option, "requires a single run; pass one --variant");
    require_safe_output(file, {.inputs = inputs});
  }
}

Playback playback_of(const RunArguments& arguments, const std::vector<datasets::SensorFault>& faults) {
  return {.start_s = arguments.start_s,
          .every = arguments.every,
          .passes = arguments.passes,
          .faults = faults,
          .gray_noise = arguments.gray_noise,
          .frames = static_cast<std::size_t>(arguments.max_frames),
          .seconds = arguments.seconds};
}

/// Sets the number of frames and the output folder of each run: --out for a single run, else a subfolder.
/// Checks that it is writable.
std::vector<ConfiguredRun> with_folders(std::vector<ConfiguredRun> runs, const RunArguments& arguments,
                                        const datasets::SequenceInfo& info) {
  const fs::path root = arguments.out.empty() ? fs::path("build/runs") / info.name : fs::path(arguments.out);
  const bool shared_root = arguments.out.empty() || runs.size() > 1;
  const std::vector<fs::path> inputs = {info.folder, arguments.rig};
  require_file_options(arguments, runs.size(), inputs);
  for (ConfiguredRun& run : runs) {
    run.spec.max_frames = frames_to_play(info.frame_times, playback_of(arguments, run.faults));
    if (!run.video.empty() && runs.size() > 1) run.video /= folder_name(run.variant);
    run.folder = shared_root ? root / folder_name(run.variant) : root;
    require_safe_folder(run.folder, run_layout(), inputs);
    if (!arguments.out.empty() && !arguments.force && has_earlier_output(run.folder, run_layout()))
      throw InputError(run.folder.string(),
                       "contains an earlier run; replace it with --force or choose another folder");
    if (!run.video.empty()) require_safe_folder(run.video, video_layout(), inputs);
    require_writable(run.folder);
  }
  return runs;
}

constexpr std::size_t kMaxLines = 5;  ///< about frames, of one kind

/// "... and 88 more frames"
void warn_of_more(std::size_t count) {
  if (count > kMaxLines) spdlog::warn("... and {} more frames", count - kMaxLines);
}

void log_update(const OdometryUpdate& update) {
  spdlog::debug("frame {}: {} features, {} landmarks, {} iterations{}", update.frame_id,
                update.counters.tracked_features, update.counters.window_landmarks,
                update.counters.solver_iterations, update.counters.keyframe ? ", keyframe" : "");
}

DumpRequest dump_request(const RunArguments& arguments, const ConfiguredRun& configured) {
  const auto requested = [&](const char* dump) { return std::ranges::count(arguments.dumps, dump) > 0; };
  return {.folder = configured.folder,
          .labels = requested("labels"),
          .cost = requested("cost"),
          .video = configured.video,
          .images = static_cast<std::size_t>(arguments.images),
          .mcap = arguments.mcap,
          .mcap_images = arguments.mcap_images,
          .map_cloud = arguments.map_cloud,
          .map_voxel_m = arguments.map_voxel_m,
          .closes_loops = configured.spec.config.loop.enabled};
}

/// Log, progress line, heartbeat, and the meters of the machine during a run.
class RunWatch {
 public:
  RunWatch(const datasets::SequenceInfo& info, const RunArguments& arguments, const ConfiguredRun& run)
      : heartbeat_(arguments.heartbeat.empty() ? std::nullopt
                                               : std::make_optional<Heartbeat>(arguments.heartbeat)),
        progress_(info.name + " " + run.variant, run.spec.max_frames, "frames"),
        monitor_(arguments.deterministic_counts ? "" : arguments.sysfs_root) {}

  void frame_done(const OdometryUpdate& update) {
    log_update(update);
    if (update.counters.reset && ++resets_ <= kMaxLines)
      spdlog::warn("frame {}: tracking failed, estimator reset", update.frame_id);
    monitor_.frame_done();
    if (heartbeat_) heartbeat_->beat(update.frame_id);
    progress_.update(static_cast<std::size_t>(update.frame_id) + 1);
  }

  [[nodiscard]] std::optional<DeviceScore> finish() {
    warn_of_more(resets_);
    return monitor_.finish();
  }

 private:
  const std::optional<Heartbeat> heartbeat_;
  ProgressLine progress_;
  RunMonitor monitor_;
  std::size_t resets_ = 0;
};

/// --sequence-id, or as `sequence_identity`; empty if interrupted.
std::string id_of(const datasets::SequenceInfo& info, const RunArguments& arguments) {
  if (interrupt_requested()) return "";
  return arguments.sequence_id.empty() ? sequence_identity(info, arguments.rig) : arguments.sequence_id;
}

RunManifest manifest_of(const datasets::SequenceInfo& info, const RunArguments& arguments,
                        const ConfiguredRun& configured) {
  std::vector<std::string> faults;
  for (const datasets::SensorFault& fault : configured.faults) faults.push_back(fault_text(fault));
  return {.sequence = info.name,
          .faults = faults,
          .sequence_format = info.format,
          .sequence_checksum = id_of(info, arguments),
          .base = arguments.base,
          .variant = configured.variant,
          .config = configured.spec.config,
          .map_checksum = configured.spec.map ? map_checksum(*configured.spec.map) : "",
          .mode = configured.spec.mode,
          .build = build_info(),
          .host = host_info(arguments.sysfs_root),
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

void print_result(const RunResult& result, const fs::path& folder, const RunArguments& arguments) {
  const std::string& sequence = arguments.sequence;
  const bool is_part = arguments.start_s > 0.0 || arguments.seconds > 0.0 || arguments.max_frames > 0;
  const std::vector<SkippedFrame>& skipped = result.run.summary.skipped;
  for (std::size_t i = 0; i < std::min(skipped.size(), kMaxLines); ++i)
    spdlog::warn("frame {} skipped: {}", skipped[i].index, skipped[i].reason);
  warn_of_more(skipped.size());
  for (const std::string& warning : result.warnings) spdlog::warn("{}", warning);
  if (!result.failure.empty()) spdlog::warn("{}", result.failure);
  std::cout << fmt::format("{} {}: {}, {} of {} frames, {}\n  {}\n", result.sequence, result.variant,
                           status_name(result.outcome), result.run.summary.frames, result.run.frames_planned,
                           score_line(result), (folder / "result.json").string());
  if (!result.gt.poses.empty())
    std::cout << fmt::format("  {} true poses; again: stillpoint eval {} {}{}\n", result.gt.poses.size(),
                             sequence, folder.string(),
                             is_part ? " (CR and coverage: of the whole sequence)" : "");
  const std::vector<RigFinding> rig = rig_report(result.run.calibration);
  if (!rig.empty()) std::cout << fmt::format("  rig: {}\n", rig_report_line(rig));
  if (const std::vector<std::string> off = run_indicators(result); !off.empty())
    std::cout << fmt::format("  {}: `stillpoint diagnose {}`\n", fmt::join(off, "; "), sequence);
}

int exit_code(Outcome outcome) {
  if (outcome == Outcome::kInterrupted) return kExitInterrupted;
  return outcome == Outcome::kLost ? kExitFindings : kExitOk;
}

/// Whether each frame is loaded once, in order, and without haste, so that it can be rendered then.
bool loads_in_order(const RunArguments& arguments) {
  return arguments.start_s == 0.0 && arguments.every == 1 && arguments.passes == 1 &&
         arguments.faults.empty() && arguments.gray_noise == 0 && arguments.mode != "realtime" &&
         !arguments.deterministic_counts;
}

/// Opens the sequence. A preset that is not in the cache is rendered while it is played, or before.
/// @return null if interrupted
std::unique_ptr<datasets::SensorStream> open(const RunArguments& arguments,
                                             const std::vector<ConfiguredRun>& runs) {
  // Instruction counts must not depend on earlier runs, the cache contains consecutive frames from frame 0
  // on, passes use all frames.
  const bool cached = !arguments.no_frame_cache && !arguments.deterministic_counts &&
                      arguments.start_s == 0.0 && arguments.every == 1;
  auto frame_cache = logged_frame_cache(cached, arguments.passes == 1 ? arguments.max_frames : 0);
  if (frame_cache && arguments.passes == 1) frame_cache->max_seconds = arguments.seconds;
  const Playback playback = playback_of(arguments, runs.front().faults);
  const auto frames = [&](std::span<const Timestamp> times) { return frames_to_load(times, playback); };
  auto stream =
      open_with_progress(resolve_sequence(arguments.sequence),
                         {.format = arguments.format,
                          .rig_file = arguments.rig,
                          .topics = arguments.topics,
                          .defer_color = std::ranges::none_of(runs, needs_color, &ConfiguredRun::spec),
                          .frame_cache = frame_cache},
                         {.frames = frames, .when_loaded = loads_in_order(arguments)});
  return stream ? played(std::move(stream), playback) : nullptr;
}

RunControl control_of(RunWatch& watch, RunDumps& dumps) {
  RunControl control{.stop_requested = interrupt_requested};
  control.on_frame.emplace_back([&](const FrameReport& report) { watch.frame_done(report.update); });
  if (dumps.needs_frames())
    control.on_frame.emplace_back([&](const FrameReport& report) { dumps.add(report); });
  return control;
}

RunResult result_of(OdometryRun executed, const datasets::SequenceInfo& info,
                    const ConfiguredRun& configured) {
  RunResult result = score_run(info, std::move(executed), configured.faults);
  result.variant = configured.variant;
  result.mode = configured.spec.mode;
  return result;
}

/// Saves the map of a run and its dumps. @return exit code
int save_map_and_dumps(const RunArguments& arguments, const RunResult& result, RunDumps& dumps) {
  if (result.run.loops && (result.run.loops->report.map || !interrupt_requested()))
    save_map(arguments.map, result.run.loops->report);
  const auto failures = dumps.finish(interrupt_requested() ? nullptr : &result.run);
  for (const std::string& failure : failures) spdlog::warn("{}", failure);
  return failures.empty() ? kExitOk : kExitFindings;
}

/// `run_odometry`; a frame that could not be rendered is an error of the command.
OdometryRun executed_run(const datasets::SensorStream& stream, const RunSpec& spec, RunControl control) {
  try {
    return run_odometry(stream, spec, std::move(control));
  } catch (const RenderingError& error) {
    throw InputError(error.what());
  }
}

/// Executes each configured run, and writes its files, then its dumps. @return exit code
int run_configs(const std::shared_ptr<const RunArguments>& shared) {
  const RunArguments& arguments = *shared;
  require_known_dumps(arguments.dumps);
  install_interrupt_handlers();
  const std::vector<ConfiguredRun> runs = plan_runs(arguments);
  const std::unique_ptr<datasets::SensorStream> stream = open(arguments, runs);
  if (!stream) return kExitInterrupted;
  const datasets::SequenceInfo& info = stream->info();
  for (const std::string& note : info.notes) spdlog::info("{}", note);
  for (const ConfiguredRun& configured : runs) require_recorded_boxes(configured.spec.config, info);
  int code = kExitOk;
  for (const ConfiguredRun& configured : with_folders(runs, arguments, info)) {
    if (interrupt_requested()) return kExitInterrupted;
    RunDumps dumps(dump_request(arguments, configured), *stream, configured.spec.config.frontend);
    std::optional<RunWatch> watch(std::in_place, info, arguments, configured);
    const double start_s = process_age_s();
    OdometryRun executed = executed_run(*stream, configured.spec, control_of(*watch, dumps));
    executed.device = watch->finish();
    RunResult result = result_of(std::move(executed), info, configured);
    result.start_s = start_s;
    watch.reset();  // removes the progress line
    write_run(configured.folder, result, manifest_of(info, arguments, configured));
    print_result(result, configured.folder, arguments);
    code = std::max({code, exit_code(result.outcome), save_map_and_dumps(arguments, result, dumps)});
  }
  return code;
}

std::vector<Option> run_options(const std::shared_ptr<RunArguments>& arguments) {
  return {
      {"SEQ", "Sequence folder, bag or preset name", &arguments->sequence},
      {"--config", "Base config: an embedded name or a TOML file", &arguments->base},
      {"--variant", "Overlays joined by +; may be repeated, each --variant is a separate run",
       &arguments->variants},
      {"--set", "Override a config key: key=value; may be repeated", &arguments->settings},
      {"--fault",
       "Inject a sensor fault: KIND or KIND:key=value,... with the keys start, duration, every [s], "
       "amount, seed; may be repeated; kinds: `stillpoint data faults`",
       &arguments->faults},
      {"--mode", "Execution mode: sequential, pipelined or realtime", &arguments->mode},
      {"--speed", "Playback speed in realtime mode; 1 = as recorded", &arguments->speed, {1e-3, 1e3}},
      {"--out", "Output folder [build/runs/SEQ/VARIANT, which is replaced]", &arguments->out},
      {"--force", "Replace an earlier run in the folder of --out", &arguments->force},
      {"--format", "Sequence format: " + datasets::sequence_format_names() + " [detected]",
       &arguments->format},
      {"--topics", kTopicsHelp, &arguments->topics},
      {"--rig", kRigHelp, &arguments->rig},
      {"--dump",
       "Additional output: labels (labels.csv, dynamic labels of all features) or cost (cost.svg, "
       "processing time of each frame; loop_cost.svg: of loop closure); may be repeated",
       &arguments->dumps},
      {"--passes", "Passes, forward and backward in turn, without IMU [1]", &arguments->passes, {1, 1000}},
      {"--video", "Write annotated frames and video.mp4 into this folder", &arguments->video},
      {"--mcap",
       "Record poses, features, boxes, status, timings and IMU in this file for Foxglove or rerun, while "
       "running",
       &arguments->mcap},
      {"--mcap-images", "Also record color (JPEG) and depth images", &arguments->mcap_images},
      {"--map-cloud", "Write the static surfaces as a colored point cloud (.ply), without people",
       &arguments->map_cloud},
      {"--map-voxel",
       "Side of the voxels of --map-cloud, one point each [0.02 m]",
       &arguments->map_voxel_m,
       {1e-3, 10.0}},
      {"--imu-rate", "Write and score the pose at each IMU sample as known then", &arguments->imu_rate},
      {"--map", "Map of an earlier run, in which this one is located", &arguments->map.load},
      {"--save-map", "Write a map for later runs, with --map an extended one", &arguments->map.save},
      {"--final-ba", "Adjust all keyframes after the last frame (loop closure)", &arguments->map.final_ba},
      {"--images", "Number of annotated images of the worst frames [0]", &arguments->images, {0, 1e6}},
      {"--sequence-id", "Identifier for the manifest [a checksum]", &arguments->sequence_id},
      {"--heartbeat", "File that receives the id of the last processed frame", &arguments->heartbeat},
      {"--start", "Time after the first frame at which the run begins [0 s]", &arguments->start_s, {0, 1e9}},
      {"--gray-noise",
       "Seed of normal noise of a gray level in the gray images, for replicates of a recording; 0 = none [0]",
       &arguments->gray_noise,
       {0, 1e9}},
      {"--every",
       "Play the first frame from --start on and every N-th after it, with all IMU samples [1]",
       &arguments->every,
       {1, 1e6}},
      {"--max-frames", "Maximum number of played frames; 0 = all", &arguments->max_frames, {0, 1e9}},
      {"--seconds", "Play the frames of this time; 0 = all [0 s]", &arguments->seconds, {0, 1e9}},
      {"--sysfs-root", kSysfsRootHelp, &arguments->sysfs_root},
      {"--no-frame-cache", "Decode all images again, and do not keep them", &arguments->no_frame_cache},
      {"--deterministic-counts", "One thread with a separate heap, for reproducible instruction counts",
       &arguments->deterministic_counts}};
}

}  // namespace

Command run_command() {
  const auto arguments = std::make_shared<RunArguments>();
  return {.name = "run",
          .summary = "Run the odometry on one sequence; write trajectory, scores and manifest",
          .example = "run walking_xyz --variant wo_circular_mask --start 5 --out /tmp/run",
          .options = run_options(arguments),
          .action = std::bind_front(run_configs, arguments)};
}

}  // namespace stillpoint::bench
