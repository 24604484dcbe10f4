// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint trajectory`: converts, cuts, joins, moves and resamples trajectory files. Covariances are
// written in the columns behind the pose (TUM, CSV), or as PoseWithCovarianceStamped or Odometry (bags).
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/analysis/pose_files.h"
#include "bench/cli/command_line.h"
#include "bench/record/output_folder.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "datasets/bags/bag_geometry.h"
#include "datasets/bags/trajectory_writer.h"
#include "eval/io/matrix_files.h"
#include "eval/io/text_reader.h"
#include "eval/io/trajectory_file.h"
#include "eval/metrics/rpe.h"
#include "eval/trajectory/alignment.h"
#include "eval/trajectory/edit.h"

namespace stillpoint::bench {
namespace {

enum class PoseFileFormat { kTum, kCsv, kEuroc, kKitti, kBag, kOdometry };
constexpr auto enum_names(PoseFileFormat) {
  return EnumNames<PoseFileFormat, 6>{{{PoseFileFormat::kTum, "tum"},
                                       {PoseFileFormat::kCsv, "csv"},
                                       {PoseFileFormat::kEuroc, "euroc"},
                                       {PoseFileFormat::kKitti, "kitti"},
                                       {PoseFileFormat::kBag, "bag"},
                                       {PoseFileFormat::kOdometry, "odometry"}}};
}

struct PoseOutput {
  std::string path;    ///< a file, or BAG:/TOPIC; KITTI also writes the stamps, to NAME_times.txt
  std::string format;  ///< of `PoseFileFormat`; empty: bag for .bag and .mcap, csv for .csv, else tum
  bool force = false;  ///< replace existing files of the same kind
};

namespace fs = std::filesystem;

constexpr std::string_view kCsvHeader = "timestamp [s],tx [m],ty [m],tz [m],qx,qy,qz,qw";

/// The file of "FILE" or "BAG:/TOPIC", and the topic.
datasets::BagTopic target_of(const std::string& path) {
  if (const std::optional<datasets::BagTopic> bag = datasets::parse_bag_topic(path)) return *bag;
  const std::size_t colon = path.find(":/");
  if (colon == std::string::npos) return {path, "/pose"};
  return {path.substr(0, colon), path.substr(colon + 1)};
}

PoseFileFormat format_of(const PoseOutput& output) {
  if (output.path.empty()) throw InputError("--out", "is required: the file to write");
  if (!output.format.empty()) return enum_of<PoseFileFormat>("--to", output.format);
  const fs::path extension = target_of(output.path).bag.extension();
  if (extension == ".bag" || extension == ".mcap" || extension == ".db3") return PoseFileFormat::kBag;
  return extension == ".csv" ? PoseFileFormat::kCsv : PoseFileFormat::kTum;
}

/// The path of the stamps of a KITTI file.
fs::path times_path(const fs::path& poses) {
  fs::path times = poses;
  return times.replace_filename(poses.stem().string() + "_times.txt");
}

/// First bytes of the files of a format, or of a container of bags.
std::string beginning_of(PoseFileFormat format, const fs::path& file) {
  switch (format) {
    case PoseFileFormat::kTum:
      return "# timestamp";
    case PoseFileFormat::kCsv:
      return std::string(kCsvHeader);
    case PoseFileFormat::kEuroc:
      return "#timestamp";
    case PoseFileFormat::kKitti:
      return "";
    case PoseFileFormat::kBag:
    case PoseFileFormat::kOdometry:
      break;
  }
  return file.extension() == ".bag" ? "#ROSBAG V2.0" : "\x89MCAP0";
}

OutputRules rules_of(const PoseOutput& output, const std::vector<std::string>& inputs) {
  OutputRules rules{.force = output.force};
  for (const std::string& input : inputs) rules.inputs.push_back(target_of(input).bag);
  rules.beginning = beginning_of(format_of(output), target_of(output.path).bag);
  return rules;
}

/// The upper triangle of the 6x6 matrix of position and rotation, row by row.
std::vector<double> upper_triangle(const eval::StampedCovariance& covariance) {
  std::vector<double> numbers;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      numbers.push_back(column < 3 ? covariance.position(row, column)
                        : row >= 3 ? covariance.rotation(row - 3, column - 3)
                                   : 0.0);
    }
  }
  return numbers;
}

/// TUM rows, with the covariances behind the poses.
std::string tum_text(const eval::CovariantTrajectory& path) {
  std::string poses = eval::format_tum(path.trajectory);
  if (path.covariances.empty()) return poses;
  std::string text;
  eval::LineReader lines(poses);
  text.append(*lines.next()).append("\n");
  for (const eval::StampedCovariance& covariance : path.covariances) {
    text.append(*lines.next());
    for (const double number : upper_triangle(covariance)) text += fmt::format(" {:.9g}", number);
    text += '\n';
  }
  return text;
}

std::string csv_text(const eval::CovariantTrajectory& path) {
  std::string rows = tum_text(path);
  rows.erase(0, rows.find('\n'));
  std::ranges::replace(rows, ' ', ',');
  std::string header(kCsvHeader);
  constexpr const char* kAxes[] = {"x", "y", "z", "rx", "ry", "rz"};
  for (int row = 0; row < 6 && !path.covariances.empty(); ++row) {
    for (int column = row; column < 6; ++column)
      header += fmt::format(",cov_{}_{}", kAxes[row], kAxes[column]);
  }
  return header + rows;
}

void write_kitti(const PoseOutput& output, const Trajectory& trajectory, const OutputRules& rules) {
  const eval::KittiTexts texts = eval::format_kitti(trajectory);
  write_output(output.path, texts.poses, rules);
  write_output(times_path(output.path), texts.times, rules);
}

/// Checks the output before the work begins.
/// @param inputs that must not be replaced; empty ones are ignored
/// @throws InputError without a path, for an unknown format, for a topic of a file that is no bag, or as
/// `require_safe_output`
void require_pose_output(const PoseOutput& output, const std::vector<std::string>& inputs) {
  const PoseFileFormat format = format_of(output);
  const OutputRules rules = rules_of(output, inputs);
  const fs::path file = target_of(output.path).bag;
  const bool is_bag = format == PoseFileFormat::kBag || format == PoseFileFormat::kOdometry;
  if (!is_bag && file != output.path)
    throw InputError(output.path, "names a topic, which only bags have; omit it, or add --to bag");
  const bool is_folder = is_bag && file.extension() != ".bag" && file.extension() != ".mcap";
  if (is_folder && fs::exists(file))
    throw InputError(file.string(), "already exists; choose another name for the folder of a bag");
  if (!is_folder) require_safe_output(file, rules);
  if (format == PoseFileFormat::kKitti) require_safe_output(times_path(file), rules);
}

/// Checks as `require_pose_output`, and writes. Covariances that the format has no place for are omitted with
/// a warning.
void write_poses(const PoseOutput& output, const eval::CovariantTrajectory& path,
                 const std::vector<std::string>& inputs) {
  require_pose_output(output, inputs);
  const PoseFileFormat format = format_of(output);
  const OutputRules rules = rules_of(output, inputs);
  const bool has_place = format != PoseFileFormat::kEuroc && format != PoseFileFormat::kKitti;
  if (!path.covariances.empty() && !has_place)
    spdlog::warn("{}: the format has no covariances; they were omitted", output.path);
  switch (format) {
    case PoseFileFormat::kTum:
      return write_output(output.path, tum_text(path), rules);
    case PoseFileFormat::kCsv:
      return write_output(output.path, csv_text(path), rules);
    case PoseFileFormat::kEuroc:
      return write_output(output.path, eval::format_euroc(path.trajectory), rules);
    case PoseFileFormat::kKitti:
      return write_kitti(output, path.trajectory, rules);
    case PoseFileFormat::kBag:
    case PoseFileFormat::kOdometry:
      break;
  }
  datasets::write_bag_trajectory(target_of(output.path), path.trajectory, path.covariances,
                                 format == PoseFileFormat::kOdometry ? datasets::TrajectoryMessage::kOdometry
                                                                     : datasets::TrajectoryMessage::kPose);
}

struct TrajectoryArguments {
  PoseFilePaths files;
  std::string input;
  std::vector<std::string> inputs;  ///< of `merge`
  PoseOutput output;
  double start_s = 0.0;
  double end_s = std::numeric_limits<double>::infinity();
  bool absolute = false;
  std::string world;
  std::string body;
  std::string align_to;
  std::string alignment = "se3";
  double scale = 1.0;
  double offset_s = 0.0;
  double rate_hz = 0.0;
  std::string at;
  double max_gap_s = 0.5;
};

/// The poses of a file with the covariances that it brings.
eval::CovariantTrajectory load_with_covariances(const TrajectoryArguments& arguments,
                                                const std::string& path) {
  PoseFile file = read_pose_file(arguments.files, path, FileRole::kEstimate);
  if (const auto finding = eval::find_implausible_stamps(file.loaded.trajectory))
    spdlog::warn("{}: {}", path, finding->message);
  eval::CovariantTrajectory loaded{std::move(file.loaded.trajectory)};
  if (file.covariances) loaded.covariances = eval::at_poses(loaded.trajectory, std::move(*file.covariances));
  return loaded;
}

/// "TX,TY,TZ,QX,QY,QZ,QW".
Pose pose_of(const std::string& option, const std::string& text) {
  eval::RowReader rows(text, option);
  const std::optional<eval::TextRow> row = rows.next();
  std::optional<Pose> pose;
  if (row && row->fields.size() == 7)
    pose = eval::parse_pose(*row, eval::consecutive_columns(0, eval::QuaternionOrder::kXyzw));
  if (!pose)
    throw InputError(option + " " + text, "expected a pose TX,TY,TZ,QX,QY,QZ,QW [m, unit quaternion]");
  return *pose;
}

int finish(const TrajectoryArguments& arguments, const eval::CovariantTrajectory& result,
           std::vector<std::string> inputs) {
  if (result.trajectory.poses.empty())
    throw InputError(arguments.output.path, "would have no pose; nothing was written");
  inputs.push_back(arguments.files.times);
  inputs.push_back(arguments.files.covariance);
  write_poses(arguments.output, result, inputs);
  std::cout << fmt::format("{}: {}{}\n", arguments.output.path,
                           counted(result.trajectory.poses.size(), "pose"),
                           result.covariances.empty() ? "" : " with covariances");
  return kExitOk;
}

int convert(const TrajectoryArguments& arguments) {
  require_pose_output(arguments.output, {arguments.input});
  return finish(arguments, load_with_covariances(arguments, arguments.input), {arguments.input});
}

int crop(const TrajectoryArguments& arguments) {
  require_pose_output(arguments.output, {arguments.input});
  if (arguments.end_s < arguments.start_s) throw InputError("--end", "is earlier than --start");
  eval::CovariantTrajectory path = load_with_covariances(arguments, arguments.input);
  const Timestamp zero = arguments.absolute ? Timestamp{0} : path.trajectory.poses.front().t;
  const double rounding_s = arguments.absolute ? 5e-7 : 0.0;  // of a stamp of this century as a double
  const Timestamp begin = after(zero, arguments.start_s - rounding_s);
  const Timestamp end = std::isinf(arguments.end_s) ? path.trajectory.poses.back().t
                                                    : after(zero, arguments.end_s + rounding_s);
  const std::string span = fmt::format("{} to {} s", eval::format_stamp(path.trajectory.poses.front().t),
                                       eval::format_stamp(path.trajectory.poses.back().t));
  eval::CovariantTrajectory part = eval::cropped(std::move(path), begin, end);
  if (part.trajectory.poses.empty())
    throw InputError(arguments.input, "has no pose in that time; its poses are from " + span);
  return finish(arguments, part, {arguments.input});
}

int merge(const TrajectoryArguments& arguments) {
  if (arguments.inputs.size() < 2)
    throw InputError("command line", "merge requires two trajectories or more");
  require_pose_output(arguments.output, arguments.inputs);
  std::vector<eval::CovariantTrajectory> parts;
  for (const std::string& path : arguments.inputs) parts.push_back(load_with_covariances(arguments, path));
  return finish(arguments, eval::merged(std::move(parts), arguments.inputs), arguments.inputs);
}

/// The similarity that --align-to, or --world and --scale, state.
eval::Similarity world_change(const TrajectoryArguments& arguments, const Trajectory& path) {
  if (arguments.align_to.empty()) {
    eval::Similarity S_w_v{.T_w_v = {}, .scale = arguments.scale};
    if (!arguments.world.empty()) S_w_v.T_w_v = pose_of("--world", arguments.world);
    return S_w_v;
  }
  if (!arguments.world.empty() || arguments.scale != 1.0)
    throw InputError("--align-to", "states the world; omit --world and --scale");
  const Trajectory gt =
      read_pose_file(arguments.files, arguments.align_to, FileRole::kTruth).loaded.trajectory;
  eval::require_overlap(gt, path, 0.0, arguments.input);
  const std::vector<eval::MatchedPose> matches = eval::strict_matches(gt, path);
  const auto kind = enum_of<eval::Alignment>("--alignment", arguments.alignment);
  const eval::AlignmentResult result = eval::align(matches, kind);
  if (!result.determined) {
    throw InputError(
        arguments.input,
        fmt::format("the alignment is not determined by {} matched poses; use --alignment first_pose",
                    matches.size()));
  }
  return result.S_w_v;
}

int transform(const TrajectoryArguments& arguments) {
  std::vector<std::string> inputs{arguments.input};
  if (!arguments.align_to.empty()) inputs.push_back(arguments.align_to);
  require_pose_output(arguments.output, inputs);
  eval::CovariantTrajectory path = load_with_covariances(arguments, arguments.input);
  for (StampedPose& pose : path.trajectory.poses) pose.t = after(pose.t, arguments.offset_s);
  for (eval::StampedCovariance& covariance : path.covariances)
    covariance.t = after(covariance.t, arguments.offset_s);
  if (!arguments.body.empty()) {
    path.trajectory = eval::move_to_frame(path.trajectory, pose_of("--body", arguments.body), "");
    if (!path.covariances.empty())
      spdlog::warn("{}: covariances are of the former body frame and were omitted", arguments.input);
    path.covariances.clear();
  }
  const eval::Similarity S_w_v = world_change(arguments, path.trajectory);
  const Pose& T = S_w_v.T_w_v;
  std::cout << fmt::format("world: {:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g} scale {:.9g}\n", T.p.x(),
                           T.p.y(), T.p.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w(), S_w_v.scale);
  return finish(arguments, eval::in_world(std::move(path), S_w_v), inputs);
}

/// Stamps of --rate from the first pose on.
std::vector<Timestamp> regular_times(const Trajectory& path, double rate_hz) {
  constexpr double kMostPoses = 1e8;
  const Timestamp begin = path.poses.front().t;
  const double duration_s = seconds_between(begin, path.poses.back().t);
  if (duration_s * rate_hz > kMostPoses)
    throw InputError(fmt::format("--rate {:g}", rate_hz), "would be more than 1e8 poses");
  std::vector<Timestamp> times;
  for (double k = 0.0; k <= duration_s * rate_hz + 1e-6; ++k) times.push_back(after(begin, k / rate_hz));
  return times;
}

int resample(const TrajectoryArguments& arguments) {
  if ((arguments.rate_hz > 0.0) == !arguments.at.empty())
    throw InputError("command line", "resample requires --rate or --at, and not both");
  std::vector<std::string> inputs{arguments.input};
  if (!arguments.at.empty()) inputs.push_back(arguments.at);
  require_pose_output(arguments.output, inputs);
  const eval::CovariantTrajectory path = load_with_covariances(arguments, arguments.input);
  std::vector<Timestamp> times;
  if (arguments.at.empty()) {
    times = regular_times(path.trajectory, arguments.rate_hz);
  } else {
    for (const StampedPose& pose :
         read_pose_file(arguments.files, arguments.at, FileRole::kTruth).loaded.trajectory.poses)
      times.push_back(pose.t);
  }
  eval::CovariantTrajectory result{eval::resampled(path.trajectory, times, arguments.max_gap_s)};
  if (!path.covariances.empty())
    spdlog::warn("{}: covariances are of the former stamps and were omitted", arguments.input);
  if (const std::size_t omitted = times.size() - result.trajectory.poses.size(); omitted > 0) {
    spdlog::warn(
        "{}: {} of {} stamps are outside of the trajectory or in gaps longer than {:g} s and have no pose",
        arguments.input, omitted, times.size(), arguments.max_gap_s);
  }
  return finish(arguments, result, inputs);
}

/// The options that all subcommands have, behind `own`.
std::vector<Option> with_common_options(std::vector<Option> own, TrajectoryArguments& a) {
  const std::vector<Option> common{
      {"--out", "File to write: .csv, .bag:/TOPIC, .mcap:/TOPIC, else TUM [topic /pose]", &a.output.path},
      {"--to",
       "Format of --out: " + enum_list<PoseFileFormat>() +
           " (nav_msgs/Odometry in a bag, with velocities 0) [by its extension]",
       &a.output.format},
      {"--format", "Format of the input: " + enum_list<eval::TrajectoryFormat>() + " [detected]",
       &a.files.formats},
      {"--times", "File of time stamps of a KITTI trajectory", &a.files.times},
      {"--seq", "Sequence number in an OpenLORIS file", &a.files.sequence, {0, 1e9}},
      {"--covariance", "File with the covariances of the poses [further columns, or messages]",
       &a.files.covariance},
      {"--force", "Replace existing files of the same kind (KITTI: of any kind)", &a.output.force}};
  own.insert(own.end(), common.begin(), common.end());
  return own;
}

struct Action {
  const char* name;
  const char* summary;
  const char* example;
  int (*execute)(const TrajectoryArguments&);
};

Command subcommand(const Action& action, const std::shared_ptr<TrajectoryArguments>& arguments,
                   std::vector<Option> own) {
  return {.name = action.name,
          .summary = action.summary,
          .example = action.example,
          .options = with_common_options(std::move(own), *arguments),
          .action = [arguments, execute = action.execute] { return execute(*arguments); }};
}

}  // namespace

Command trajectory_command() {
  const auto arguments = std::make_shared<TrajectoryArguments>();
  TrajectoryArguments& a = *arguments;
  const Option input{"IN", "Trajectory: a file, or BAG:/TOPIC", &a.input};
  return {.name = "trajectory",
          .summary = "Convert, cut, join, move and resample trajectory files",
          .example = "trajectory convert poses.csv --out poses.tum",
          .subcommands = {
              subcommand({"convert", "Write another format", "trajectory convert run.bag:/odom --out run.tum",
                          convert},
                         arguments, {input}),
              subcommand({"crop", "Write the poses of a time span",
                          "trajectory crop run.tum --start 5 --end 30 --out part.tum", crop},
                         arguments,
                         {input,
                          {"--start", "Begin [s after the first pose]", &a.start_s, {-1e9, 1e10}},
                          {"--end", "End [s after the first pose; the last pose]", &a.end_s, {-1e9, 1e10}},
                          {"--absolute", "--start and --end are stamps", &a.absolute}}),
              subcommand({"merge", "Join parts of a run that follow each other",
                          "trajectory merge a.tum b.tum --out all.tum", merge},
                         arguments, {{"IN", "Trajectories: files, or BAG:/TOPIC", &a.inputs}}),
              subcommand(
                  {"transform", "Change world, body frame, scale and stamps",
                   "trajectory transform run.tum --align-to gt.tum --out aligned.tum", transform},
                  arguments,
                  {input,
                   {"--world", "Pose of the present world in the new one: TX,TY,TZ,QX,QY,QZ,QW", &a.world},
                   {"--body", "Pose of the new body frame in the present one: TX,TY,TZ,QX,QY,QZ,QW", &a.body},
                   {"--scale", "Factor of the positions", &a.scale, {1e-9, 1e9}},
                   {"--offset", "Offset to add to the stamps [s]", &a.offset_s, {-1e9, 1e9}},
                   {"--align-to", "Ground truth to whose world the poses are aligned", &a.align_to},
                   {"--alignment", "With --align-to: " + enum_list<eval::Alignment>(), &a.alignment}}),
              subcommand(
                  {"resample", "Interpolate poses at other times",
                   "trajectory resample run.tum --rate 30 --out r.tum", resample},
                  arguments,
                  {input,
                   {"--rate", "Poses per second from the first one on [Hz]", &a.rate_hz, {1e-6, 1e6}},
                   {"--at", "Trajectory with the stamps", &a.at},
                   {"--max-gap", "Longest interval that is interpolated [s]", &a.max_gap_s, {1e-9, 1e9}}})}};
}

}  // namespace stillpoint::bench
