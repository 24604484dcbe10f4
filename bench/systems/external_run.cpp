// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/external_run.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/model/scale_fit.h"
#include "bench/record/result_values.h"
#include "bench/record/run_environment.h"
#include "bench/run/run_result.h"
#include "bench/systems/cached_export.h"
#include "bench/systems/module_times.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/calibration/rig_yaml_text.h"
#include "datasets/faults/faulty_stream.h"
#include "datasets/faults/rig_faults.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_export.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"
#include "eval/trajectory/alignment.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<datasets::SensorFault> faults_of(const RunRequest& request) {
  if (request.fault.empty()) return {};
  const std::vector<datasets::SensorFault> faults = {datasets::parse_fault(request.fault)};
  return datasets::expanded_rigs(faults);
}

std::unique_ptr<datasets::SensorStream> started(const RunRequest& request) {
  return datasets::start_at(datasets::open_sequence(request.sequence), request.start_s);
}

bool is_changed(const RunRequest& request) {
  return request.max_frames > 0 || request.start_s > 0.0 || !request.fault.empty();
}

std::string name_of(ExportLayout layout) {
  for (const auto& [value, name] : enum_names(layout)) {
    if (value == layout) return std::string(name);
  }
  return "";
}

bool is_bag(ExportLayout layout) { return layout == ExportLayout::kBag || layout == ExportLayout::kMcap; }

/// Where the sequence is exported to in a layout.
fs::path export_path(const RunRequest& request, ExportLayout layout) {
  const std::string start = request.start_s > 0.0 ? fmt::format("-from-{:.6f}", request.start_s) : "";
  const fs::path folder =
      datasets::cache_folder() / "exports" / (request.identity.sequence_id + "-" + name_of(layout) + start);
  const std::string name = request.sequence.filename().string();
  return folder / (is_bag(layout) ? name + "." + name_of(layout) : name);
}

/// Folder or bag of the sequence in a layout. The identity of the run contains its fault and its frame limit.
fs::path exported(const RunRequest& request, ExportLayout layout) {
  if (layout == ExportLayout::kAsIs) {
    if (!is_changed(request)) return request.sequence;
    throw InputError("layout",
                     "\"as_is\" passes the recorded files, which have no fault, later start or frame "
                     "limit; use layout = \"tum\" or \"euroc\"");
  }
  const fs::path path = export_path(request, layout);
  if (export_state(path) == ExportState::kIntact) return path;
  auto stream = datasets::first_frames(started(request), static_cast<std::size_t>(request.max_frames));
  if (stream->info().format == name_of(layout) && !is_changed(request)) return request.sequence;
  require_export(path, [&] {
    stream = datasets::with_faults(std::move(stream), faults_of(request));
    if (is_bag(layout)) {
      datasets::export_bag(*stream, path);
    } else {
      layout == ExportLayout::kTum ? datasets::export_tum(*stream, path)
                                   : datasets::export_euroc(*stream, path);
    }
  });
  return path;
}

Placeholders placeholders_of(const ExternalSystem& system, const RunRequest& request,
                             const fs::path& sequence) {
  Placeholders values = folder_placeholders(system);
  values["sequence"] = fs::absolute(sequence).string();
  values["out"] = fs::absolute(request.work).string();
  values["seed"] = std::to_string(request.identity.seed);
  values["repetition"] = std::to_string(request.identity.repetition);
  values["speed"] = request.identity.mode.ends_with("realtime") ? "1" : "0";
  if (has_calibration(system))
    values["calibration"] = (fs::absolute(request.work) / system.calibration_file).string();
  for (const auto& [name, value] : system.param) values[std::string(kParamPrefix) + name] = value;
  if (request.identity.axis.starts_with(kParamPrefix))
    values[request.identity.axis] = fmt::format("{}", request.identity.axis_value);
  return values;
}

SensorRates rates_of(const datasets::SequenceInfo& info) {
  const auto rate = [](std::size_t count, double span_s) {
    return count > 1 && span_s > 0.0 ? static_cast<double>(count - 1) / span_s : 0.0;
  };
  const auto& frames = info.frame_times;
  const double frames_s = frames.size() > 1 ? seconds_between(frames.front(), frames.back()) : 0.0;
  const double imu_s = info.imu.size() > 1 ? seconds_between(info.imu.front().t, info.imu.back().t) : 0.0;
  return {.frames_per_s = rate(frames.size(), frames_s), .imu_hz = rate(info.imu.size(), imu_s)};
}

void write_calibration(const ExternalSystem& system, const RunRequest& request, Placeholders values) {
  const std::unique_ptr<datasets::SensorStream> stream = played_sequence(request);
  const datasets::SequenceInfo& info = stream->info();
  const fs::path file = request.work / system.calibration_file;
  fs::create_directories(file.parent_path());
  if (!system.calibration_format.empty()) {
    Rig rig = info.rig;
    if (system.layout != ExportLayout::kAsIs) rig.imu_axes = {};  // the exported samples are corrected
    for (const auto& [format, name] : enum_names(datasets::RigFormat{})) {
      if (name == system.calibration_format) eval::write_text_file(file, datasets::rig_text(rig, format));
    }
    return;
  }
  const fs::path source = fs::path(system.folder) / system.calibration_template;
  values.merge(calibration_placeholders(info.rig, rates_of(info)));
  eval::write_text_file(file, expanded(eval::read_text_file(source), values, source.string()));
}

/// That of this process, with the variables of the system.
std::vector<std::string> environment_of(const ExternalSystem& system, const Placeholders& values) {
  std::vector<std::string> environment;
  for (const std::string& variable : system.environment)
    environment.push_back(expanded(variable, values, system.path));
  const std::size_t own = environment.size();
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view inherited = *variable;
    const std::string_view name = inherited.substr(0, inherited.find('=') + 1);
    const bool is_replaced = std::any_of(environment.begin(), environment.begin() + static_cast<long>(own),
                                         [&](const std::string& set) { return set.starts_with(name); });
    if (!is_replaced) environment.emplace_back(inherited);
  }
  return environment;
}

/// Lets the process start the program in a container.
/// @param values of the placeholders
/// @throws InputError if a folder cannot be mounted
ProcessSpec in_container(const ExternalSystem& system, const RunRequest& request, const Placeholders& values,
                         ProcessSpec spec) {
  const bool is_apptainer = system.runner == ContainerRunner::kApptainer;
  std::vector<std::string> words = {is_apptainer ? "exec" : "run"};
  if (is_apptainer) words.insert(words.end(), {"--containall", "--net"});
  words.insert(words.end(),
               {"--network=none", (is_apptainer ? "--pwd=" : "--workdir=") + spec.folder.string()});
  for (const char* const name : {"sequence", "here", "out"}) {
    const std::string& path = values.at(name);
    if (path.find(':') != std::string::npos)
      throw InputError(path, "contains a colon, which separates the parts of a mount; use another folder");
    words.push_back(fmt::format("--{}={}:{}{}", is_apptainer ? "bind" : "volume", path, path,
                                std::string_view(name) == "out" ? "" : ":ro"));
  }
  for (const std::string& variable : system.environment)
    words.push_back("--env=" + expanded(variable, values, system.path));
  if (!is_apptainer) words.emplace_back("--rm");
  if (!is_apptainer && request.memory_limit_mb > 0)
    words.push_back(fmt::format("--memory={}m", request.memory_limit_mb));
  // Killing the runner does not end its container.
  if (system.runner == ContainerRunner::kPodman && request.time_limit_s > 0.0)
    words.push_back(fmt::format("--timeout={:.0f}", std::ceil(request.time_limit_s)));
  words.insert(words.end(), system.runner_options.begin(), system.runner_options.end());
  words.insert(words.end(), {system.image, spec.program.string()});
  words.insert(words.end(), spec.arguments.begin(), spec.arguments.end());
  for (const auto& [runner, name] : enum_names(system.runner)) {
    if (runner == system.runner) spec.program = name;
  }
  spec.arguments = std::move(words);
  spec.folder = request.work;
  return spec;
}

RunOutcome failed(Outcome outcome, const std::string& detail) {
  RunOutcome result;
  result.outcome = outcome;
  result.detail = one_line(detail);
  return result;
}

}  // namespace

std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  return escaped_utf8(text);
}

std::vector<eval::ClaimedPose> claims_of(const Trajectory& trajectory, std::span<const Timestamp> frames) {
  constexpr double kSameStamp_s = 1e-3;  // > rounding of stamps in files with 6 decimals
  std::vector<eval::ClaimedPose> claims;
  auto pose = trajectory.poses.begin();
  for (const Timestamp t : frames) {
    while (pose != trajectory.poses.end() && pose->t < after(t, -kSameStamp_s)) ++pose;
    eval::ClaimedPose claim{.t = t, .T_w_c = {}};
    if (pose != trajectory.poses.end() && pose->t < after(t, kSameStamp_s)) {
      claim.T_w_c = pose->T_w_f;
      claim.claim = eval::PoseClaim::kLocated;
    } else if (!claims.empty() && claims.back().claim != eval::PoseClaim::kNone) {
      claim.claim = eval::PoseClaim::kLost;
    }
    claims.push_back(claim);
  }
  return claims;
}

std::unique_ptr<datasets::SensorStream> played_sequence(const RunRequest& request) {
  return datasets::with_faults(started(request), faults_of(request));
}

bool reaches_external_systems(const std::string& fault) {
  const datasets::FaultTarget target = descriptor_of(datasets::parse_fault(fault).kind).target;
  return target != datasets::FaultTarget::kArrival && target != datasets::FaultTarget::kDetections;
}

SystemTrajectory read_output(const ExternalSystem& system, const fs::path& work,
                             const datasets::SequenceInfo& info) {
  eval::TrajectorySource source{.path = work / system.trajectory};
  std::string text = eval::read_text_file(source.path);
  eval::LoadedTrajectory loaded;
  if (system.trajectory_format == OutputFormat::kKitti) {
    std::string times;
    for (const Timestamp t : info.frame_times) times += eval::format_stamp(t) + "\n";
    source.format = eval::TrajectoryFormat::kKitti;
    source.times = work / "frame_times.txt";
    eval::write_text_file(source.times, times);
    loaded = eval::read_trajectory(source);
  } else if (system.trajectory_format == OutputFormat::kEuroc) {
    loaded = eval::parse_euroc(text, system.trajectory);
  } else {
    loaded = eval::parse_tum(text, system.trajectory);
  }
  SystemTrajectory output{.trajectory = std::move(loaded.trajectory), .text = "", .log = ""};
  for (const std::string& repair : eval::repair_texts(loaded.repairs))
    output.log += system.trajectory + ": " + repair + "\n";
  if (system.inverse) {
    for (StampedPose& pose : output.trajectory.poses) pose.T_w_f = pose.T_w_f.inverse();
  }
  if (system.poses == PosedFrame::kBody)
    output.trajectory = eval::move_to_frame(output.trajectory, info.rig.T_b_c, "camera");
  output.trajectory.frame = "camera";
  const bool is_as_written = system.trajectory_format == OutputFormat::kTum && !system.inverse &&
                             system.poses == PosedFrame::kCamera;
  output.text = is_as_written ? std::move(text) : eval::format_tum(output.trajectory);
  return output;
}

ProcessSpec ExternalRun::command(const RunRequest& request) const {
  const fs::path sequence = exported(request, system_.layout);
  fs::create_directories(request.work);
  const Placeholders values = placeholders_of(system_, request, sequence);
  if (has_calibration(system_)) write_calibration(system_, request, values);
  std::vector<std::string> words;
  for (const std::string& word : system_.command) words.push_back(expanded(word, values, system_.path));
  ProcessSpec spec;
  spec.program = program_of(system_, words.front());
  spec.arguments.assign(words.begin() + 1, words.end());
  spec.folder = fs::path(system_.folder) / expanded(system_.working_folder, values, system_.path);
  spec.environment = environment_of(system_, values);
  spec.output_in_messages = true;
  return is_contained() ? in_container(system_, request, values, std::move(spec)) : spec;
}

namespace {

/// Multiplies the positions of a system without scale.
void apply_scale(SystemTrajectory& output, const datasets::SequenceInfo& info) {
  const double scale = fit_scale(
      output.trajectory,
      eval::move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera"));
  output.text = eval::format_tum(output.trajectory);
  output.log += fmt::format("positions multiplied by {:.6g}{}\n", scale, kScaleFitted);
}

/// Why the poses of a trajectory tell no error; empty if they do.
std::string pose_problem(const Trajectory& trajectory, const std::vector<Timestamp>& frames) {
  const std::vector<StampedPose>& poses = trajectory.poses;
  if (poses.size() < 2) return "has only one pose, which tells no error";
  if (frames.empty() || (poses.back().t >= frames.front() && poses.front().t <= frames.back())) return "";
  return fmt::format(
      "has poses from {} to {} s, but the frames are from {} to {} s; write the stamps of the frames",
      eval::format_stamp(poses.front().t), eval::format_stamp(poses.back().t),
      eval::format_stamp(frames.front()), eval::format_stamp(frames.back()));
}

RunOutcome scored(const ExternalSystem& system, const RunRequest& request, const datasets::SequenceInfo& info,
                  const ProcessResult& process) {
  SystemTrajectory output = read_output(system, request.work, info);
  RunOutcome result;
  const std::string problem = pose_problem(output.trajectory, info.frame_times);
  if (!problem.empty()) {
    result = failed(Outcome::kLost, system.trajectory + " " + problem);
    if (!output.log.empty()) result.attachments["log"] = output.log;
    return result;
  }
  const bool is_scaled = system.scale == PositionScale::kUnknown;
  if (is_scaled) apply_scale(output, info);
  if (!output.log.empty()) result.attachments["log"] = output.log;
  OdometryRun run;
  run.summary.frames = info.frame_times.size();
  if (request.max_frames > 0)
    run.summary.frames = std::min(run.summary.frames, static_cast<std::size_t>(request.max_frames));
  run.claims = claims_of(output.trajectory, std::span(info.frame_times).first(run.summary.frames));
  run.trajectory = std::move(output.trajectory);
  const RunResult score = score_run(info, std::move(run), faults_of(request));
  result.detail =
      one_line(score.conventions.empty() ? error_doubt(score.warnings) : score.conventions.front().message);
  result.metrics = measured_metrics({.scored = measurements_of(score).scored, .honesty = score.honesty});
  if (is_scaled) state_fitted_scale(result.metrics);
  result.attachments["trajectory"] = std::move(output.text);
  result.costs = read_module_times(system, request.work, process);
  return result;
}

}  // namespace

std::string ExternalRun::manifest(const RunRequest& request) const {
  Json json;
  json["schema"] = 1;
  json["system"] = {{"name", system_.name},
                    {"version", system_.version},
                    {"command", system_.command},
                    {"folder", system_.folder},
                    {"description", system_.text}};
  // What the history of the system uses as its commit; the gate stores other builds.
  json["build"] = {{"git_commit", system_.version}};
  if (!request.commit_time.empty()) json["build"]["git_time"] = request.commit_time;
  if (!request.fault.empty()) json["faults"] = {request.fault};
  json["sequence"] = {{"name", request.identity.sequence}, {"id", request.identity.sequence_id}};
  json["host"] = host_json(host_info());
  return json.dump(2) + "\n";
}

RunOutcome ExternalRun::outcome(const RunRequest& request, const ProcessResult& process) const {
  const bool is_exported = system_.layout != ExportLayout::kAsIs;
  if (is_exported && export_state(export_path(request, system_.layout)) == ExportState::kChanged)
    return failed(
        Outcome::kBadData,
        "files of the sequence were changed during the run; let programs write to {out} only, not to "
        "{sequence}, which other runs read");
  if (process.exit_code != 0) {
    const std::string last = last_line(process.messages);
    return failed(Outcome::kCrashed,
                  fmt::format("exited with code {}{}{}", process.exit_code, last.empty() ? "" : ": ", last));
  }
  if (!fs::exists(request.work / system_.trajectory))
    return failed(Outcome::kLost, "wrote no " + system_.trajectory);
  std::unique_ptr<datasets::SensorStream> stream;
  try {
    stream = played_sequence(request);
  } catch (const InputError& error) {  // of a layout that is not exported
    return failed(Outcome::kBadData, error.what());
  }
  try {
    return scored(system_, request, stream->info(), process);
  } catch (const InputError& error) {
    return failed(Outcome::kCrashed, error.what());
  }
}

}  // namespace stillpoint::bench
