// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint calibrate`: runs the odometry on recordings, and estimates the calibration from its tracks.
#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/run/calibration_report.h"
#include "bench/cli/run/sequence_playback.h"
#include "bench/config/config_file.h"
#include "bench/diagnose/evidence/recording_survey.h"
#include "bench/plan/plan_sequences.h"
#include "bench/record/output_folder.h"
#include "bench/run/odometry_run.h"
#include "core/base/error.h"
#include "core/calibration/calibrate.h"
#include "core/calibration/calibration_recording.h"
#include "core/geometry/so3.h"
#include "datasets/angular_rates.h"
#include "datasets/calibration/rig_yaml_text.h"
#include "eval/io/trajectory_file.h"
#include "reports/drawing/drawing.h"
#include "reports/drawing/theme.h"

namespace stillpoint::bench {
namespace {

constexpr double kLeastInterval_s = 0.1;  // between keyframes
constexpr double kMostKeyframes = 300.0;
constexpr std::size_t kIterationsPerRound = 25;
constexpr double kLargestTruthDelay_s = 0.5;
constexpr double kLargestTruthResidual = 0.6;  // of the rotation between the rates, relative to them
constexpr std::size_t kLeastTruthFrames = 30;

struct CalibrateArguments {
  std::string out, plot, out_format, rig, format, truth, base = "stillpoint", variant;
  std::vector<std::string> sequences, settings, topics, faults, keep;
  double start_s = 0.0;
  int max_frames = 0;
  bool depth_camera = false, json = false;
};

/// The switches of --keep.
struct NamedSwitch {
  std::string_view name;
  bool CalibrationSwitches::*value;
};
constexpr std::array<NamedSwitch, 11> kSwitches = {
    {{"focal", &CalibrationSwitches::focal},
     {"center", &CalibrationSwitches::center},
     {"distortion", &CalibrationSwitches::distortion},
     {"rolling_shutter", &CalibrationSwitches::rolling_shutter},
     {"depth_scale", &CalibrationSwitches::depth_scale},
     {"depth_offset", &CalibrationSwitches::depth_offset},
     {"depth_intrinsics", &CalibrationSwitches::depth_intrinsics},
     {"depth_pose", &CalibrationSwitches::depth_pose},
     {"extrinsics", &CalibrationSwitches::extrinsics},
     {"time_offset", &CalibrationSwitches::time_offset},
     {"imu_intrinsics", &CalibrationSwitches::imu_intrinsics}}};

std::string switch_names() {
  std::string names;
  for (const NamedSwitch& entry : kSwitches) names += (names.empty() ? "" : ", ") + std::string(entry.name);
  return names;
}

CalibrationSwitches switches_of(const CalibrateArguments& arguments) {
  CalibrationSwitches switches;
  for (const std::string& name : arguments.keep) {
    const auto found = std::ranges::find(kSwitches, name, &NamedSwitch::name);
    if (found == kSwitches.end())
      throw InputError("--keep", "unknown parameter \"" + name + "\"; expected one of: " + switch_names());
    switches.*(found->value) = false;
  }
  return switches;
}

OutputRules rules_of(const CalibrateArguments& arguments) {
  return {.inputs = {arguments.rig, arguments.truth}, .beginning = {}};
}

/// @param raw_depth without registration of depth images to the color camera
/// @return null if interrupted
std::unique_ptr<datasets::SensorStream> open_stream(const CalibrateArguments& arguments,
                                                    const std::string& sequence, bool raw_depth) {
  const bool cached = arguments.start_s == 0.0 && !raw_depth;
  auto stream = open_with_progress(resolve_sequence(sequence),
                                   {.format = arguments.format,
                                    .rig_file = arguments.rig,
                                    .topics = arguments.topics,
                                    .raw_depth = raw_depth,
                                    .defer_color = true,
                                    .frame_cache = logged_frame_cache(cached, arguments.max_frames)});
  if (!stream) return nullptr;
  return played(std::move(stream), {.start_s = arguments.start_s, .faults = parsed_faults(arguments.faults)});
}

/// Time of the frames that are used [s].
double duration_s(const datasets::SequenceInfo& info, int max_frames) {
  if (info.frame_times.empty()) return 0.0;
  const std::size_t count = max_frames == 0
                                ? info.frame_times.size()
                                : std::min(info.frame_times.size(), static_cast<std::size_t>(max_frames));
  return seconds_between(info.frame_times.front(), info.frame_times[count - 1]);
}

/// The depth images of another camera as they are.
void load_raw_depth(const CalibrateArguments& arguments, const std::string& sequence,
                    CalibrationInput& input) {
  const std::unique_ptr<datasets::SensorStream> raw = open_stream(arguments, sequence, true);
  if (!raw) return;
  for (CalibrationSection& section : input.sections) {
    for (CalibrationKeyframe& keyframe : section.keyframes) {
      const Frame frame = raw->load_frame(static_cast<std::size_t>(keyframe.frame));
      keyframe.depth = frame.depth;
      keyframe.gray = frame.gray;
    }
  }
}

/// A recording to calibrate from.
struct Recording {
  std::string sequence;
  std::unique_ptr<datasets::SensorStream> stream;
  OdometryConfig config;
  CalibrationInput input;  ///< without keyframes until it was tracked
};

/// What is stated about the device, and the inertial data.
Recording opened_recording(const CalibrateArguments& arguments, const std::string& sequence,
                           std::unique_ptr<datasets::SensorStream> stream) {
  const datasets::SequenceInfo& info = stream->info();
  const bool inertial = info.rig.has_imu && !info.imu.empty();
  const std::string variant = arguments.variant.empty() && !inertial ? "vo" : arguments.variant;
  const OdometryConfig config = load_config({arguments.base, variant, arguments.settings});
  CalibrationInput input{.stated = {.rig = info.rig, .depth_camera = info.rig.camera},
                         .gravity = config.imu.gravity,
                         .depth_is_registered = !info.depth_camera && !arguments.depth_camera};
  input.stated.depth_camera.distortion.fill(0.0);
  if (inertial && config.imu.enabled) input.imu = info.imu;
  if (info.depth_camera) {
    input.stated.depth_camera = info.depth_camera->camera;
    input.stated.T_c_d = info.depth_camera->T_c_d;
  }
  return {sequence, std::move(stream), config, std::move(input)};
}

/// Mean rates of the body from frame to frame of one world.
class FrameRates {
 public:
  void add(const OdometryUpdate& update, Timestamp t) {
    if (is_located(update.status) && segment_ == update.segment) {
      const double interval_s = seconds_between(t_, t);
      const Eigen::Quaterniond turned = q_w_b_.conjugate() * update.state.T_w_b.q;
      rates_.push_back({t_, t, log_so3(turned) / interval_s});
    }
    segment_ = is_located(update.status) ? update.segment : -1;
    t_ = t;
    q_w_b_ = update.state.T_w_b.q;
  }
  [[nodiscard]] const std::vector<datasets::RateInterval>& intervals() const { return rates_; }

 private:
  int segment_ = -1;
  Timestamp t_;
  Eigen::Quaterniond q_w_b_ = Eigen::Quaterniond::Identity();
  std::vector<datasets::RateInterval> rates_;
};

/// Delay and rotation by the angular rates of both.
/// @throws InputError if the ground truth is not of this time, or does not turn as the recording does
CalibrationTruth started_truth(const std::string& file, const Trajectory& trajectory,
                               std::vector<datasets::RateInterval> rates) {
  const auto is_apart = [&](const datasets::RateInterval& interval) {
    return trajectory.poses.empty() || interval.from < trajectory.poses.front().t ||
           trajectory.poses.back().t < interval.to;
  };
  std::erase_if(rates, is_apart);
  if (rates.empty())
    throw InputError(file,
                     "has no poses at the time of the frames; give the ground truth of this recording, "
                     "stamped to half a second by its clock");
  const datasets::RateIntegral truth(trajectory);
  constexpr int kSteps = 100;
  datasets::RotationFit best{.residual = kLargestTruthResidual};
  int best_step = kSteps;
  for (int step = -kSteps; step <= kSteps; ++step) {
    const std::vector<datasets::RatePair> pairs =
        rate_pairs(truth, rates, kLargestTruthDelay_s * step / kSteps);
    if (pairs.size() < kLeastTruthFrames || 2 * pairs.size() < rates.size()) continue;
    const datasets::RotationFit fit = fit_rotation(pairs);
    if (fit.residual >= best.residual) continue;
    best = fit;
    best_step = step;
  }
  if (std::abs(best_step) == kSteps)
    throw InputError(
        file, fmt::format("does not turn as the recording does, over at least {} frames at a delay below {} "
                          "s; give the ground truth of this recording, with orientations at 10 Hz or more",
                          kLeastTruthFrames, kLargestTruthDelay_s));
  return {.trajectory = trajectory,
          .T_f_b = Pose{best.q_a_b, Eigen::Vector3d::Zero()},
          .delay_s = kLargestTruthDelay_s * best_step / kSteps};
}

/// Adds the keyframes of a run of the odometry. @return whether it was not interrupted
/// @param interval_s between keyframes
bool track(const CalibrateArguments& arguments, Recording& recording, double interval_s) {
  const datasets::SensorStream& stream = *recording.stream;
  const datasets::SequenceInfo& info = stream.info();
  const RunSpec spec{.config = recording.config,
                     .max_frames = static_cast<std::size_t>(arguments.max_frames)};
  CalibrationCollector collector(interval_s);
  FrameRates rates;
  ProgressLine progress("tracking " + info.name, info.frame_times.size(), "frames");
  RunControl control{.stop_requested = interrupt_requested};
  control.on_frame.emplace_back([&](const FrameReport& report) {
    collector.add(report.tracked, report.dynamic.labels, report.update);
    rates.add(report.update, report.tracked.t);
    progress.update(static_cast<std::size_t>(report.update.frame_id) + 1);
  });
  const OdometryRun run = run_odometry(stream, spec, control);
  if (run.summary.interrupted) return false;
  recording.input.sections = collector.finish();
  CalibrationTruth& truth = recording.input.truth;
  if (!arguments.truth.empty()) truth = started_truth(arguments.truth, truth.trajectory, rates.intervals());
  if (info.depth_camera) load_raw_depth(arguments, recording.sequence, recording.input);
  return true;
}

CalibrationResult estimate(const CalibrateArguments& arguments, const CalibrationInput& input) {
  std::optional<ProgressLine> line;
  const CalibrationOptions options{
      .estimate = switches_of(arguments), .on_iteration = [&](const CalibrationProgress& now) {
        const std::size_t total = kIterationsPerRound * static_cast<std::size_t>(now.steps);
        if (!line) line.emplace("calibrating", total, "iterations");
        const std::size_t done = kIterationsPerRound * static_cast<std::size_t>(now.step) +
                                 static_cast<std::size_t>(now.iteration);
        line->update(std::min(done, total), fmt::format("calibrating, round {} of {}, cost {:.1f}",
                                                        now.step + 1, now.steps, now.cost));
        spdlog::debug("round {} of {}, iteration {}: cost {}", now.step + 1, now.steps, now.iteration,
                      now.cost);
        return !interrupt_requested();
      }};
  return calibrate(input, options);
}

datasets::RigFormat out_format_of(const CalibrateArguments& arguments) {
  if (arguments.out_format.empty()) return datasets::RigFormat::kStillpoint;
  if (arguments.out.empty()) throw InputError("--out-format", "is that of --out, which is missing");
  return enum_of<datasets::RigFormat>("--out-format", arguments.out_format);
}

void write_plot(const CalibrateArguments& arguments, const datasets::SensorStream& stream,
                const CalibrationSubject& subject, const CalibrationResult& result) {
  constexpr double kPixelsPerPoint = report::theme::kPixelsPerInch / 72.0;
  if (!result.has_held_out) {
    spdlog::warn(
        "--plot: there are no held-out residuals, as the calibration was not completed; no figure is "
        "written");
    return;
  }
  const std::array<report::Drawing, 2> figures{residual_figure(result.held_out, stream.info().rig.camera),
                                               parameter_figure(subject, result)};
  report::write_drawings(arguments.plot, figures, kPixelsPerPoint, rules_of(arguments));
}

/// @return empty if interrupted
/// @throws InputError if one is given twice, or two are not of one device
std::vector<Recording> open_recordings(const CalibrateArguments& arguments) {
  std::vector<Recording> recordings;
  std::set<std::string> names;
  for (const std::string& sequence : arguments.sequences) {
    if (!names.insert(std::filesystem::weakly_canonical(sequence).string()).second)
      throw InputError(sequence,
                       "is given twice, which would count its data twice; give each recording once");
    auto stream = open_stream(arguments, sequence, false);
    if (!stream) return {};
    for (const std::string& note : stream->info().notes) spdlog::info("{}", note);
    for (const std::string& warning : stream->info().warnings) spdlog::warn("{}", warning);
    require_depth_or_imu(*stream);
    recordings.push_back(opened_recording(arguments, sequence, std::move(stream)));
    const Recording& first = recordings.front();
    if (const std::string text = stated_difference(first.input, recordings.back().input); !text.empty())
      throw InputError(first.sequence + ", " + sequence,
                       "are not of one device: " + text +
                           "; calibrate recordings of one device, and give the calibration to start from "
                           "with --rig");
  }
  return recordings;
}

/// The keyframes of all recordings. @return nothing if interrupted
std::optional<CalibrationInput> track_all(const CalibrateArguments& arguments,
                                          std::vector<Recording>& recordings) {
  double all_s = 0.0;
  for (const Recording& recording : recordings)
    all_s += duration_s(recording.stream->info(), arguments.max_frames);
  std::optional<CalibrationInput> all;
  for (Recording& recording : recordings) {
    if (!track(arguments, recording, std::max(kLeastInterval_s, all_s / kMostKeyframes))) return std::nullopt;
    if (recordings.size() > 1 && recording.input.sections.empty())
      throw InputError(recording.sequence, "the odometry located no frame; leave it out, or correct the rig");
    if (!all) {
      all = std::move(recording.input);
    } else {
      append_recording(*all, std::move(recording.input));
    }
  }
  return all;
}

int calibrate_sequences(const CalibrateArguments& arguments) {
  static_cast<void>(switches_of(arguments));
  const datasets::RigFormat format = out_format_of(arguments);
  if (!arguments.out.empty()) require_safe_output(arguments.out, rules_of(arguments));
  if (!arguments.plot.empty()) report::require_drawing_file(arguments.plot, rules_of(arguments));
  Trajectory truth;
  if (!arguments.truth.empty()) {
    if (arguments.sequences.size() > 1)
      throw InputError("--truth", "is that of one recording, and several are given; calibrate one");
    truth = eval::read_trajectory({.path = arguments.truth}).trajectory;
  }
  install_interrupt_handlers();
  std::vector<Recording> recordings = open_recordings(arguments);
  if (recordings.empty()) return kExitInterrupted;
  recordings.front().input.truth.trajectory = std::move(truth);
  const std::optional<CalibrationInput> input = track_all(arguments, recordings);
  if (!input) return kExitInterrupted;
  const CalibrationResult result = estimate(arguments, *input);
  std::string names;
  for (const Recording& recording : recordings)
    names += (names.empty() ? "" : ", ") + recording.stream->info().name;
  const CalibrationSubject subject{
      .sequence = names, .has_imu = !input->imu.empty(), .has_depth_camera = !input->depth_is_registered};
  std::cout << (arguments.json ? calibration_json(subject, result) : calibration_table(subject, result));
  if (!arguments.out.empty())
    write_output(arguments.out, calibration_file_text(subject, result, format), rules_of(arguments));
  if (!arguments.plot.empty()) write_plot(arguments, *recordings.front().stream, subject, result);
  if (result.interrupted) return kExitInterrupted;
  return result.usable ? kExitOk : kExitInconclusive;
}

}  // namespace

Command calibrate_command() {
  const auto a = std::make_shared<CalibrateArguments>();
  return {
      .name = "calibrate",
      .summary = "Estimate the calibration from recordings, without a target; write a rig file",
      .example =
          "calibrate walking_xyz --out rig.toml\n"
          "  stillpoint calibrate walking_xyz --truth mocap.tum --out rig.toml",
      .options =
          {{"SEQ", "Sequence folders, bags or preset names, of one device", &a->sequences},
           {"--out", "Rig file to write; an existing file is not replaced", &a->out},
           {"--plot",
            "Figure of the held-out residuals over the image, before and after, and of the parameters "
            "(.pdf, .svg, .png or .html)",
            &a->plot},
           {"--out-format", "Program that is to read --out: " + enum_list<datasets::RigFormat>() + " [toml]",
            &a->out_format},
           {"--keep", "Keep a parameter as stated: " + switch_names() + "; may be repeated", &a->keep},
           {"--depth-camera",
            "Depth images are those of another camera, not registered: estimate its intrinsics and pose",
            &a->depth_camera},
           {"--truth",
            "File with the ground truth of the recording: poses are drawn to it; its delay and T_f_b, the "
            "pose "
            "of the body (IMU, without one the camera) in its frame, are estimated",
            &a->truth},
           {"--rig", kRigHelp, &a->rig},
           {"--config", "Base config: an embedded name or a TOML file", &a->base},
           {"--variant", "Overlays joined by + [vo without an IMU]", &a->variant},
           {"--set", "Override a config key: key=value; may be repeated", &a->settings},
           {"--fault", "Inject a sensor fault, as `run --fault`; may be repeated", &a->faults},
           {"--format", "Sequence format: " + datasets::sequence_format_names() + " [detected]", &a->format},
           {"--topics", kTopicsHelp, &a->topics},
           {"--start",
            "Time after the first frame at which the recording is used [0 s]",
            &a->start_s,
            {0, 1e9}},
           {"--max-frames", "Maximum number of frames; 0 = all", &a->max_frames, {0, 1e9}},
           {"--json", "Print JSON with full precision", &a->json}},
      .action = [a] { return calibrate_sequences(*a); }};
}

}  // namespace stillpoint::bench
