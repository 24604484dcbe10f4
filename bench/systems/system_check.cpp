// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/system_check.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/process/child_process.h"
#include "bench/systems/cached_export.h"
#include "bench/systems/external_run.h"
#include "bench/systems/file_states.h"
#include "bench/systems/module_times.h"
#include "core/base/error.h"
#include "datasets/cache/cache_space.h"
#include "datasets/open_sequence.h"
#include "datasets/sequence_export.h"
#include "datasets/synthetic/sequence/render_sequence.h"
#include "eval/compare/conventions.h"
#include "eval/io/text_reader.h"
#include "eval/score.h"
#include "eval/trajectory/alignment.h"
#include "eval/trajectory/orientations.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSmokePreset = "walking_halfsphere_empty";
constexpr double kSmoke_s = 3.0;
constexpr std::int64_t kMessageLimit = std::int64_t{16} << 20;  // far above a line per image
constexpr std::size_t kShownFiles = 3;

/// The sequence with the axes of the body turned: x forward, y left, z up. Those of the rendered one are
/// nearly parallel to those of the camera, so that poses of either look alike.
class TurnedBody final : public datasets::SensorStream {
 public:
  explicit TurnedBody(std::unique_ptr<datasets::SensorStream> stream)
      : stream_(std::move(stream)), info_(stream_->info()) {
    Eigen::Matrix3d R;  // of the axes of the camera: right, down, forward
    R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    info_.rig.T_b_c = Pose{Eigen::Quaterniond(R), Eigen::Vector3d::Zero()} * info_.rig.T_b_c;
    for (ImuSample& sample : info_.imu) {
      sample.gyro_b = R * sample.gyro_b;
      sample.accel_b = R * sample.accel_b;
    }
  }
  [[nodiscard]] const datasets::SequenceInfo& info() const override { return info_; }
  [[nodiscard]] Frame load_frame(std::size_t index) const override { return stream_->load_frame(index); }
  [[nodiscard]] std::optional<datasets::MotionLabels> load_labels(std::size_t index) const override {
    return stream_->load_labels(index);
  }

 private:
  std::unique_ptr<datasets::SensorStream> stream_;
  datasets::SequenceInfo info_;
};

RunRequest smoke_run(const ExternalSystem& system, const fs::path& work) {
  synth::SynthRequest scene = synth::preset_request(kSmokePreset);
  scene.seconds = kSmoke_s;
  RunRequest request;
  request.identity.system = system.name;
  request.identity.sequence = "smoke";
  request.identity.sequence_id = "smoke-" + synth::request_key(scene);
  request.sequence = datasets::cache_folder() / "exports" / request.identity.sequence_id / "smoke";
  require_export(request.sequence, [&] {
    const TurnedBody stream(datasets::open_sequence(synth::cached_sequence(scene)));
    datasets::export_tum(stream, request.sequence);
  });
  request.work = work;
  return request;
}

// ---- Files that the program changes.

/// A folder in which a program must not write.
struct WatchedFolder {
  fs::path path;
  int depth = 0;           ///< of subfolders
  bool is_shared = false;  ///< other programs may write there, too
};

std::vector<WatchedFolder> watched_folders(const ExternalSystem& system, const fs::path& sequence,
                                           const fs::path& folder) {
  constexpr int kSequenceDepth = 3;
  std::vector<WatchedFolder> folders = {{sequence, kSequenceDepth, false}, {folder, 1, false}};
  const char* const home = std::getenv("HOME");
  std::vector<fs::path> shared = {fs::temp_directory_path(), fs::current_path()};
  if (home != nullptr) shared.emplace_back(home);
  if (std::ranges::find(shared, fs::path(system.folder)) == shared.end())
    folders.push_back({system.folder, 1, false});
  for (const fs::path& path : shared) folders.push_back({path, 0, true});
  return folders;
}

FileStates files_of(const std::vector<WatchedFolder>& folders, bool is_shared, const fs::path& out) {
  FileStates states;
  for (const WatchedFolder& folder : folders) {
    if (folder.is_shared == is_shared) add_files(states, fs::absolute(folder.path), folder.depth, out);
  }
  return states;
}

/// Files that a running process has open: those of other programs, as the system does not run.
std::set<fs::path> open_files() {
  std::set<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator process("/proc", error), end; !error && process != end;
       process.increment(error)) {
    std::error_code ended;
    for (fs::directory_iterator file(process->path() / "fd", ended), last; !ended && file != last;
         file.increment(ended)) {
      std::error_code ignored;
      files.insert(fs::read_symlink(file->path(), ignored));
    }
  }
  return files;
}

// ---- The process.

/// An execution of the program, and the files that it changed outside of its folder.
struct Trial {
  ProcessResult process;
  std::vector<fs::path> outside;  ///< in folders of its own
  std::vector<fs::path> shared;   ///< in folders that other programs use, too
};

ProcessSpec trial_spec(const ExternalSystem& system, const RunRequest& request, const CheckOptions& options) {
  ProcessSpec spec = ExternalRun(system).command(request);
  spec.time_limit_s = options.time_limit_s;
  spec.memory_limit_bytes = std::int64_t{options.memory_limit_mb} << 20;
  spec.message_limit_bytes = kMessageLimit;
  std::erase_if(*spec.environment, [](const std::string& variable) {
    return variable.starts_with("DISPLAY=") || variable.starts_with("WAYLAND_DISPLAY=");
  });
  return spec;
}

/// The path of the sequence in the command, to be watched.
fs::path exported_sequence(const ProcessSpec& spec, const RunRequest& request) {
  for (const std::string& word : spec.arguments) {
    if (word.find("/exports/" + request.identity.sequence_id) != std::string::npos && fs::is_directory(word))
      return word;
  }
  return request.sequence;
}

Trial try_system(const ExternalSystem& system, const RunRequest& request, const CheckOptions& options) {
  fs::remove_all(request.work);
  const ProcessSpec spec = trial_spec(system, request, options);
  const fs::path out = fs::absolute(request.work);
  const std::vector<WatchedFolder> folders =
      watched_folders(system, exported_sequence(spec, request), options.folder);
  const FileStates own = files_of(folders, false, out);
  const FileStates shared = files_of(folders, true, out);
  std::set<fs::path> others = open_files();
  Trial trial{.process = run_process(spec), .outside = {}, .shared = {}};
  trial.outside = changed_files(own, files_of(folders, false, out));
  trial.shared = written_files(shared, files_of(folders, true, out));
  if (!trial.shared.empty()) {
    others.merge(open_files());
    std::erase_if(trial.shared, [&](const fs::path& file) { return others.contains(file); });
  }
  eval::write_text_file(options.folder / "program.log", trial.process.messages);
  return trial;
}

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool mentions_display(const std::string& messages) {
  constexpr std::size_t kLastBytes = 4000;
  const std::string end = lower(messages.substr(messages.size() - std::min(messages.size(), kLastBytes)));
  return end.find("display") != std::string::npos || end.find("qt.qpa") != std::string::npos ||
         end.find("gtk") != std::string::npos;
}

constexpr const char* kDisplayFinding =
    "needs a display; start it without its viewer by an argument or a setting, or by command = "
    "[\"xvfb-run\", "
    "\"-a\", ...]";

std::string limit_finding(const ProcessResult& end, const CheckOptions& options) {
  if (end.timed_out) {
    return mentions_display(end.messages)
               ? kDisplayFinding
               : fmt::format(
                     "did not end within {:g} s on a sequence of {:g} s; make it exit after the last "
                     "image, without waiting for input, or raise --time-limit",
                     options.time_limit_s, kSmoke_s);
  }
  if (end.out_of_memory) {
    return fmt::format(
        "used more than {} MB of memory on a sequence of {:g} s; free what it no longer needs, "
        "or raise --memory-limit",
        options.memory_limit_mb, kSmoke_s);
  }
  if (end.too_many_messages) {
    return fmt::format(
        "printed more than {} MB on a sequence of {:g} s; reduce its messages, for which it "
        "waits while they are read",
        kMessageLimit >> 20, kSmoke_s);
  }
  return "";
}

std::string exit_finding(const ProcessResult& end) {
  if (end.signal == 0 && end.exit_code == 0) return "";
  if (mentions_display(end.messages)) return kDisplayFinding;  // Qt aborts
  if (end.signal != 0) {
    return fmt::format(
        "was terminated by signal {} ({}); see program.log, and start the command "
        "under a debugger",
        end.signal, strsignal(end.signal));
  }
  const std::string last = last_line(end.messages);
  if (last.find("error while loading shared libraries") != std::string::npos)
    return last + "; add environment = [\"LD_LIBRARY_PATH=...\"]";
  const bool misses_file = last.find("No such file") != std::string::npos;
  return fmt::format("exited with code {}{}{}; {}", end.exit_code, last.empty() ? "" : ": ", last,
                     misses_file ? "paths are relative to {out}: name files beside the description by "
                                   "{here}/FILE, or set working_folder"
                                 : "correct the arguments in command, or make it exit with 0");
}

std::string outside_finding(const std::vector<fs::path>& files) {
  if (files.empty()) return "";
  std::vector<std::string> shown;
  for (const fs::path& file : files) {
    if (shown.size() < kShownFiles) shown.push_back(file.string());
  }
  return fmt::format(
      "wrote outside of its folder: {}{}; write to {{out}} only, which is also its working folder",
      fmt::join(shown, ", "), files.size() > kShownFiles ? ", ..." : "");
}

/// Files whose names differ in digits at most: process ids and times.
std::vector<fs::path> common_files(const std::vector<fs::path>& a, const std::vector<fs::path>& b) {
  const auto without_digits = [](const fs::path& file) {
    std::string name = file.string();
    std::erase_if(name, [](unsigned char c) { return std::isdigit(c) != 0; });
    return name;
  };
  std::vector<fs::path> common;
  std::ranges::copy_if(b, std::back_inserter(common), [&](const fs::path& file) {
    return std::ranges::find(a, without_digits(file), without_digits) != a.end();
  });
  return common;
}

/// What is wrong with the process; executes it again if files in folders of other programs changed.
std::string process_finding(const ExternalSystem& system, const RunRequest& request,
                            const CheckOptions& options, Trial& trial) {
  trial = try_system(system, request, options);
  if (std::string finding = limit_finding(trial.process, options); !finding.empty()) return finding;
  if (std::string finding = exit_finding(trial.process); !finding.empty()) return finding;
  if (!trial.outside.empty()) return outside_finding(trial.outside);
  if (trial.shared.empty()) return "";
  const std::vector<fs::path> first = trial.shared;
  trial = try_system(system, request, options);
  return outside_finding(common_files(first, trial.shared));
}

// ---- The trajectory.

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::vector<std::string> fields_of_line(std::string line) {
  std::ranges::replace_if(
      line, [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
  std::vector<std::string> fields;
  for (std::size_t begin = line.find_first_not_of(' '); begin != std::string::npos;) {
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    fields.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(' ', end);
  }
  return fields;
}

std::string files_in_output(const fs::path& work) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(work, ignored)) {
    if (entry.is_regular_file() && names.size() < kShownFiles)
      names.push_back(entry.path().lexically_relative(work).string());
  }
  std::ranges::sort(names);
  return names.empty() ? "and no other file there; check the output argument in command"
                       : fmt::format("but {}; set trajectory to the file", fmt::join(names, ", "));
}

/// @param messages of the program, which may have printed an error and ended with 0
std::string missing_file_finding(const ExternalSystem& system, const fs::path& work,
                                 const std::string& messages) {
  const std::string last = last_line(messages);
  return fmt::format("wrote no {} in {{out}}, {}{}", system.trajectory, files_in_output(work),
                     last.empty() ? "" : fmt::format("; it printed last: {}", last));
}

/// Faults of the rows that a reader would reject or skip.
std::string text_finding(const ExternalSystem& system, const fs::path& work, const std::string& messages) {
  const fs::path file = work / system.trajectory;
  if (!fs::exists(file)) return missing_file_finding(system, work, messages);
  const std::string text = eval::read_text_file(file);
  std::vector<std::string> lines = lines_of(text);
  std::erase_if(lines, [](const std::string& line) { return line.empty() || line.front() == '#'; });
  if (lines.empty())
    return fmt::format(
        "{} has no poses; see what the program printed: it did not initialize, or read no image",
        system.trajectory);
  const std::size_t columns = fields_of_line(lines.front()).size();
  const std::size_t last = fields_of_line(lines.back()).size();
  if (lines.size() > 1 && last < columns) {
    return fmt::format(
        "the last line of {} is incomplete: {} of {} values; close the file before the program "
        "ends",
        system.trajectory, last, columns);
  }
  const auto is_not_finite = [](const std::string& line) {
    const std::vector<std::string> fields = fields_of_line(lower(line));
    return std::ranges::any_of(fields, [](const std::string& field) {
      return field.ends_with("nan") || field.ends_with("inf") || field.ends_with("infinity") ||
             field.ends_with("nan(ind)");
    });
  };
  const auto count = std::ranges::count_if(lines, is_not_finite);
  if (count == 0) return "";
  return fmt::format("{} of {} rows of {} contain NaN or infinity; write no row for an image without a pose",
                     count, lines.size(), system.trajectory);
}

/// Ground truth of the camera, and the frames.
struct SmokeTruth {
  Trajectory gt;
  Pose T_b_c;
  std::vector<Timestamp> frames;
};

std::optional<eval::ConventionFinding> violation(const Trajectory& gt, const Trajectory& estimate) {
  std::vector<eval::ConventionFinding> findings = eval::find_convention_violations(gt, estimate);
  if (findings.empty()) return std::nullopt;
  // Inverted poses also look like another scale or a time offset, which reduce the error less.
  const auto inverted =
      std::ranges::find(findings, eval::Convention::kInvertedPoses, &eval::ConventionFinding::convention);
  return inverted != findings.end() ? *inverted : findings.front();
}

/// Poses of the body read as those of the camera, or the reverse.
bool explained_by_other_frame(const ExternalSystem& system, const SmokeTruth& truth,
                              const Trajectory& estimate) {
  const Pose T = system.poses == PosedFrame::kCamera ? truth.T_b_c : truth.T_b_c.inverse();
  return !violation(truth.gt, eval::move_to_frame(estimate, T, "camera"));
}

/// Largest error of an estimate that follows the motion, relative to the RMS distance of the true positions
/// from their mean.
constexpr double kMaxRelativeError = 0.5;

double spread_of(const Trajectory& trajectory) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const StampedPose& pose : trajectory.poses) mean += pose.T_w_f.p;
  mean /= static_cast<double>(trajectory.poses.size());
  double squared = 0.0;
  for (const StampedPose& pose : trajectory.poses) squared += (pose.T_w_f.p - mean).squaredNorm();
  return std::sqrt(squared / static_cast<double>(trajectory.poses.size()));
}

/// ATE after a similarity alignment [m]. Any positions come closer to the true ones if they are scaled to a
/// point.
double scaled_error(const Trajectory& gt, const Trajectory& estimate) {
  const auto matches = eval::matched_poses(gt, estimate, eval::associate_tum(gt, estimate));
  const eval::Similarity S = eval::align(matches, eval::Alignment::kSim3).S_w_v;
  double squared = 0.0;
  for (const eval::MatchedPose& match : matches) squared += (match.gt.p - S * match.est.p).squaredNorm();
  return matches.empty() ? 0.0 : std::sqrt(squared / static_cast<double>(matches.size()));
}

/// Whether the orientations differ by more than the drift of a few seconds.
bool is_turned(const Trajectory& gt, const Trajectory& estimate) {
  constexpr double kMaxDrift_deg = 20.0;
  const std::optional<eval::AteResult> ate = eval::ate(gt, estimate);
  return ate && ate->rotation_deg.rmse > kMaxDrift_deg;
}

std::string convention_finding(const ExternalSystem& system, const SmokeTruth& truth,
                               const Trajectory& estimate) {
  const std::optional<eval::ConventionFinding> found = violation(truth.gt, estimate);
  if (!found) return "";
  Trajectory explained = estimate;
  if (found->convention == eval::Convention::kInvertedPoses) {
    for (StampedPose& pose : explained.poses) pose.T_w_f = pose.T_w_f.inverse();
  }
  // By chance, poses without relation to the motion look like those of another convention.
  const bool is_of_poses = found->convention == eval::Convention::kScale ||
                           found->convention == eval::Convention::kBodyFrame ||
                           found->convention == eval::Convention::kInvertedPoses;
  if (is_of_poses && scaled_error(truth.gt, explained) > kMaxRelativeError * spread_of(truth.gt)) return "";
  switch (found->convention) {
    case eval::Convention::kInvertedPoses:
      return fmt::format("{}; set inverse = {}", found->message, system.inverse ? "false" : "true");
    case eval::Convention::kBodyFrame:
      if (explained_by_other_frame(system, truth, estimate)) {
        const bool is_body = system.poses == PosedFrame::kCamera;
        return fmt::format("the poses are those of the {}, not of the {}; set poses = \"{}\"",
                           is_body ? "body (IMU)" : "camera", is_body ? "camera" : "body (IMU)",
                           is_body ? "body" : "camera");
      }
      return is_turned(truth.gt, estimate) ? found->message : "";
    case eval::Convention::kScale:
      return found->message.substr(0, found->message.rfind(';')) +
             "; check the factor of the depth images, or set scale = \"unknown\" for a monocular system";
    case eval::Convention::kStampUnit:
      return found->message + "; write the stamps of the images, in seconds";
    case eval::Convention::kTimeOffset:
      return found->message + "; write the stamps of the images without an offset";
    default:
      return found->message;
  }
}

double path_length(const Trajectory& trajectory) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < trajectory.poses.size(); ++i)
    length_m += (trajectory.poses[i].T_w_f.p - trajectory.poses[i - 1].T_w_f.p).norm();
  return length_m;
}

/// Poses for few images: at a lower rate, in a part of the sequence, or at other times.
std::string rate_finding(const SmokeTruth& truth, const Trajectory& estimate, double coverage) {
  constexpr double kMinCoverage = 0.5;
  if (coverage >= kMinCoverage) return "";
  const double frame_s = seconds_between(truth.frames.front(), truth.frames.back()) /
                         static_cast<double>(truth.frames.size() - 1);
  const double span_s = seconds_between(estimate.poses.front().t, estimate.poses.back().t);
  const double interval_s = span_s / static_cast<double>(estimate.poses.size() - 1);
  if (interval_s > 1.5 * frame_s && span_s > 0.6 * kSmoke_s) {
    return fmt::format(
        "writes poses at {:.0f} Hz for images at {:.0f} Hz; write a pose for each image, not for "
        "keyframes only",
        1.0 / interval_s, 1.0 / frame_s);
  }
  if (span_s > 0.6 * kSmoke_s)
    return "the stamps of the poses are not those of the images; write the stamp of the image with each pose";
  return fmt::format(
      "has poses for {:.0f} % of the images only, the first {:.1f} s after the first image; make "
      "it initialize earlier, or raise its number of features",
      100.0 * coverage, seconds_between(truth.frames.front(), estimate.poses.front().t));
}

/// For a trajectory that cannot be read: the format that its rows have, if that is another one.
std::string format_remedy(const ExternalSystem& system, const fs::path& work) {
  constexpr std::size_t kNanosecondDigits = 18, kMatrixColumns = 12;
  for (const std::string& line : lines_of(eval::read_text_file(work / system.trajectory))) {
    const std::vector<std::string> fields = fields_of_line(line);
    if (fields.empty() || fields.front().find_first_not_of("0123456789.") != std::string::npos) continue;
    const std::size_t digits = std::min(fields.front().find('.'), fields.front().size());
    if (digits >= kNanosecondDigits && system.trajectory_format != OutputFormat::kEuroc)
      return "set trajectory_format = \"euroc\"";
    if (fields.size() == kMatrixColumns && system.trajectory_format != OutputFormat::kKitti)
      return "set trajectory_format = \"kitti\"";
    break;
  }
  return "set trajectory_format, or write rows \"t x y z qx qy qz qw\"";
}

SystemCheck trajectory_check(const ExternalSystem& system, const RunRequest& request,
                             const ProcessResult& process) {
  try {
    if (std::string finding = text_finding(system, request.work, process.messages); !finding.empty())
      return {finding, ""};
  } catch (const InputError& error) {  // a folder, or no text
    return {error.what(), ""};
  }
  const std::unique_ptr<datasets::SensorStream> stream = played_sequence(request);
  const datasets::SequenceInfo& info = stream->info();
  const SmokeTruth truth{
      .gt = eval::move_to_frame(info.ground_truth.trajectory, info.ground_truth.T_c_f.inverse(), "camera"),
      .T_b_c = info.rig.T_b_c,
      .frames = info.frame_times};
  Trajectory estimate;
  try {
    estimate = read_output(system, request.work, info).trajectory;
  } catch (const InputError& error) {
    return {fmt::format("{}; {}", error.what(), format_remedy(system, request.work)), ""};
  }
  if (estimate.poses.size() < 2)
    return {system.trajectory + " has one pose only; write a pose for each image", ""};
  if (system.scale == PositionScale::kUnknown) {
    const auto matches = eval::matched_poses(truth.gt, estimate, eval::associate_tum(truth.gt, estimate));
    const double scale = eval::align(matches, eval::Alignment::kSim3).S_w_v.scale;
    for (StampedPose& pose : estimate.poses) pose.T_w_f.p *= scale > 0.0 ? scale : 1.0;
  }
  if (std::string finding = convention_finding(system, truth, estimate); !finding.empty())
    return {finding, ""};
  eval::ScoreOptions options;
  options.expected_times = truth.frames;
  const eval::Score score = eval::score(truth.gt, estimate, options);
  if (std::string finding = rate_finding(truth, estimate, score.coverage.value_or(0.0)); !finding.empty())
    return {finding, ""};
  if (const std::string missing = eval::missing_orientations(truth.gt, estimate); !missing.empty())
    return {fmt::format("{}; write the orientation of the camera with each pose", missing), ""};
  const double length_m = path_length(truth.gt);
  const double ate_m = score.ate ? score.ate->translation_m.rmse : length_m;
  if (ate_m > kMaxRelativeError * spread_of(truth.gt)) {
    return {
        fmt::format("the poses do not follow the motion: an ATE of {:.3f} m on a path of {:.2f} m, which no "
                    "convention explains; check the calibration and the unit of depth",
                    ate_m, length_m),
        ""};
  }
  const std::string peak_memory =
      process.peak_memory_bytes
          ? fmt::format(", {:.0f} MB", 1e-6 * static_cast<double>(*process.peak_memory_bytes))
          : "";
  return {"", fmt::format("{} poses for {} images, ATE {:.4f} m on a path of {:.2f} m, {:.1f} s{}",
                          estimate.poses.size(), truth.frames.size(), ate_m, length_m, process.wall_s,
                          peak_memory)};
}

}  // namespace

SystemCheck check_system(const ExternalSystem& system, const CheckOptions& options) {
  if (find_program(system).empty()) {
    const std::string program = program_of(system, with_folders(system, system.command.front()));
    if (system.runner != ContainerRunner::kNone)
      return {"the runner of its container is not found; install it, or correct the key runner", ""};
    return {one_line(fmt::format("{} is not found; build it, or correct the first word of command", program)),
            ""};
  }
  fs::create_directories(options.folder);
  RunRequest request = smoke_run(system, options.folder / "out");
  request.time_limit_s = options.time_limit_s;
  request.memory_limit_mb = options.memory_limit_mb;
  Trial trial;
  const std::string finding = process_finding(system, request, options, trial);
  if (!finding.empty()) return {one_line(finding), ""};
  SystemCheck check = trajectory_check(system, request, trial.process);
  if (check.finding.empty()) check.finding = times_problem(system, request.work, trial.process);
  check.finding = one_line(check.finding);
  return check;
}

}  // namespace stillpoint::bench
