// SPDX-License-Identifier: BSD-3-Clause
/// Description of an external SLAM system: a TOML file that states how to start the program, what it reads
/// and what it writes, so that it is executed, limited and scored like this odometry. bench/README.md, "Any
/// system", is its manual.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "bench/config/config_keys.h"
#include "core/base/fields.h"
#include "core/types/rig.h"

namespace stillpoint::bench {

/// Dataset layout that a system reads.
enum class ExportLayout {
  kAsIs,   ///< the original folder, without export
  kTum,    ///< TUM RGB-D: rgb/, depth/, their lists, groundtruth.txt; imu.txt and rig.toml
  kEuroc,  ///< EuRoC ASL: mav0/cam0, mav0/imu0; no depth
  kBag,    ///< a bag of ROS 1, with the topics of realsense-ros; see datasets/sequence_export.h
  kMcap,   ///< the same as MCAP, for ROS 2
};
constexpr auto enum_names(ExportLayout) {
  return EnumNames<ExportLayout, 5>{{{ExportLayout::kAsIs, "as_is"},
                                     {ExportLayout::kTum, "tum"},
                                     {ExportLayout::kEuroc, "euroc"},
                                     {ExportLayout::kBag, "bag"},
                                     {ExportLayout::kMcap, "mcap"}}};
}

/// Formats of the trajectories of systems.
enum class OutputFormat { kTum, kEuroc, kKitti };
constexpr auto enum_names(OutputFormat) {
  return EnumNames<OutputFormat, 3>{
      {{OutputFormat::kTum, "tum"}, {OutputFormat::kEuroc, "euroc"}, {OutputFormat::kKitti, "kitti"}}};
}

/// What the poses of a system are those of.
enum class PosedFrame { kCamera, kBody };
constexpr auto enum_names(PosedFrame) {
  return EnumNames<PosedFrame, 2>{{{PosedFrame::kCamera, "camera"}, {PosedFrame::kBody, "body"}}};
}

/// Unit of the positions of a system.
enum class PositionScale {
  kMetric,   ///< meters
  kUnknown,  ///< of a monocular system: fitted to the ground truth, which the protocol of each metric states
};
constexpr auto enum_names(PositionScale) {
  return EnumNames<PositionScale, 2>{
      {{PositionScale::kMetric, "metric"}, {PositionScale::kUnknown, "unknown"}}};
}

/// Unit of the times in CSV files and lines of text.
enum class TimingUnit { kMilliseconds, kSeconds, kMicroseconds, kNanoseconds };
constexpr auto enum_names(TimingUnit) {
  return EnumNames<TimingUnit, 4>{{{TimingUnit::kMilliseconds, "ms"},
                                   {TimingUnit::kSeconds, "s"},
                                   {TimingUnit::kMicroseconds, "us"},
                                   {TimingUnit::kNanoseconds, "ns"}}};
}

/// Program that starts a container.
enum class ContainerRunner { kNone, kPodman, kDocker, kApptainer };
constexpr auto enum_names(ContainerRunner) {
  return EnumNames<ContainerRunner, 4>{{{ContainerRunner::kNone, "none"},
                                        {ContainerRunner::kPodman, "podman"},
                                        {ContainerRunner::kDocker, "docker"},
                                        {ContainerRunner::kApptainer, "apptainer"}}};
}

/// Where the program of a system is built from: the table [source] of a description.
struct SystemSource {
  std::string git = ".";           ///< folder of a repository, relative to {here}
  std::vector<std::string> build;  ///< program and arguments, executed in the work tree of a commit; no shell
  std::string binary;              ///< the built program, relative to the work tree; empty: no source
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, SystemSource>
void visit_fields(Visitor&& field, Config& config) {
  field("git", config.git);
  field("build", config.build);
  field("binary", config.binary);
}

/// Contents of a description. Placeholders in `command`, `environment`, `working_folder` and the template of
/// the calibration:
///
///   {sequence}     folder or bag of the sequence, in `layout`
///   {out}          output folder of the run, empty
///   {calibration}  the file written from `calibration_template`, or in `calibration_format`
///   {here}         folder of the description
///   {bin}          folder of the program `stillpoint`
///   {source}       with [source]: the work tree of the commit that is measured, else the repository itself
///   {binary}       with [source]: the built program in {source}
///   {seed}, {repetition}  of the run
///   {speed}        of the playback: 1 in plans with mode = "realtime", else 0, as fast as possible
///   {param.NAME}   value of NAME in the table [param], of a parameter set, or of the sweep
///
/// and in the template also those of `calibration_placeholders`.
struct ExternalSystem {
  std::string name;
  std::string version = "unknown";   ///< the build of its runs
  std::vector<std::string> command;  ///< program and arguments; a program with a slash: relative to {here}
  ExportLayout layout = ExportLayout::kTum;
  std::string working_folder = "{out}";  ///< relative to {here}
  std::vector<std::string> environment;  ///< "NAME=value", added to that of this program
  std::string calibration_template;      ///< text file, relative to {here}; empty: none
  std::string calibration_format;  ///< name of a `datasets::RigFormat`, in place of a template; empty: none
  std::string calibration_file = "calibration.yaml";  ///< in {out}: the template with its values
  std::string trajectory = "trajectory.tum";          ///< relative to {out}
  OutputFormat trajectory_format = OutputFormat::kTum;
  PosedFrame poses = PosedFrame::kCamera;
  bool inverse = false;  ///< the poses are T_c_w or T_b_w
  PositionScale scale = PositionScale::kMetric;
  std::string timings;  ///< in {out}: times of modules as JSON, CSV or text, see module_times.h; may be empty
  TimingUnit timing_unit = TimingUnit::kMilliseconds;  ///< of CSV and text
  /// The program is executed in a container without network, in which {sequence} and {here} are read-only and
  /// {out} is writable, at the same paths. {bin} and [source] are errors.
  ContainerRunner runner = ContainerRunner::kNone;
  std::string image;                         ///< of the container, e.g. "localhost/my_slam:1"
  std::vector<std::string> runner_options;   ///< further options of the runner, before the image
  SystemSource source;                       ///< the table [source]
  std::map<std::string, std::string> param;  ///< the table [param]: values of {param.NAME}
  std::map<std::string, std::string>
      timing;           ///< the table [timing]: column of a CSV, or pattern, of a module
  std::string variant;  ///< name, and "+SET" for each parameter set that was applied: that of its runs
  // Set by load_external_system.
  std::string text;           ///< of the description
  std::string path;           ///< of the file, as shown in messages
  std::string folder;         ///< {here}
  std::string source_folder;  ///< {source}; empty without [source]
  std::string hash;  ///< of the description, its template, its program, and files of the command with {here}
                     ///< or {bin}
  std::string hash_without_source;  ///< the same without the files of {source}, which its commit determines
};
template <class Visitor, class Config>
requires std::is_same_v<std::remove_const_t<Config>, ExternalSystem>
void visit_fields(Visitor&& field, Config& config) {
  field("name", config.name);
  field("version", config.version);
  field("command", config.command);
  field("layout", config.layout);
  field("working_folder", config.working_folder);
  field("environment", config.environment);
  field("calibration_template", config.calibration_template);
  field("calibration_format", config.calibration_format);
  field("calibration_file", config.calibration_file);
  field("trajectory", config.trajectory);
  field("trajectory_format", config.trajectory_format);
  field("poses", config.poses);
  field("inverse", config.inverse);
  field("scale", config.scale);
  field("timings", config.timings);
  field("timing_unit", config.timing_unit);
  field("runner", config.runner);
  field("image", config.image);
  field("runner_options", config.runner_options);
  field("source", config.source);
}

/// Beginning of the keys of parameters, in descriptions and in sweeps of plans.
inline constexpr std::string_view kParamPrefix = "param.";

/// Beginning of the keys of the times of modules.
inline constexpr std::string_view kTimingPrefix = "timing.";

/// A description, and the parameter sets that are applied to it in this order.
struct SystemName {
  std::string file;               ///< name of an embedded file, or path
  std::vector<std::string> sets;  ///< of the tables [variant.SET], which override values of [param]
};

/// "FILE", or "FILE+SET+SET".
[[nodiscard]] SystemName parse_system_name(std::string name);

/// @param name of an embedded file, or path of one that ends in ".toml", with parameter sets as for
/// `parse_system_name`
/// @throws InputError with file and line for every fault of the file; if there is no such file or set; if
/// name or command are missing, a placeholder is unknown, or the template cannot be read
[[nodiscard]] ExternalSystem load_external_system(const std::string& name);

/// The same for a text.
/// @param text of the description
/// @param path of the file, as shown in messages; its folder is {here}
/// @param sets names of the parameter sets
[[nodiscard]] ExternalSystem parse_external_system(const std::string& text, const std::string& path,
                                                   const std::vector<std::string>& sets = {});

/// Whether a name is that of a description: an embedded one, or a file with the key `command`. Parameter sets
/// may follow.
[[nodiscard]] bool is_description(const std::string& name);

/// The keys of two descriptions whose values differ, with those of [param] after the applied sets. A
/// parameter that only one has is empty in the other.
[[nodiscard]] std::vector<DifferentKey> different_keys(const ExternalSystem& a, const ExternalSystem& b);

/// The files that determine a run beside the description: its template, its program, and files of the command
/// with {here}, {bin} or {source}. Those that do not exist, and the program of an image, are left out.
[[nodiscard]] std::vector<std::string> files_of(const ExternalSystem& system);

/// The path of a file relative to the folder of the description; empty if it is not below that folder.
/// @param file absolute
[[nodiscard]] std::string path_below(const ExternalSystem& system, const std::string& file);

/// Whether the system has a file {calibration}.
[[nodiscard]] bool has_calibration(const ExternalSystem& system);

/// Whether `timings` names a CSV file: [timing] then has names of columns, else patterns.
[[nodiscard]] bool is_timing_table(const ExternalSystem& system);

/// A commented description with all keys, to be edited; valid as it is.
/// @param name of the system
[[nodiscard]] std::string description_template(const std::string& name);

/// Values by the names of the placeholders.
using Placeholders = std::map<std::string, std::string>;

/// The text with all placeholders replaced. Braces that contain anything but a name are not changed.
/// @param place for messages
/// @throws InputError for a name without a value
[[nodiscard]] std::string expanded(std::string_view text, const Placeholders& values,
                                   const std::string& place);

struct SensorRates {
  double frames_per_s = 0.0;
  double imu_hz = 0.0;  ///< 0 without an IMU
};

/// Placeholders of the template of a calibration: fx, fy, cx, cy [px], width, height, k1, k2, p1, p2, k3
/// to k6 (radial-tangential; k1 to k4 of Kannala-Brandt), model, fps (rounded), depth_units_per_m, T_b_c and
/// T_c_b (16 numbers, row by row, separated by commas), gyro_noise, accel_noise, gyro_walk, accel_walk
/// (continuous-time densities), imu_rate [Hz], time_offset_s.
[[nodiscard]] Placeholders calibration_placeholders(const Rig& rig, const SensorRates& rates);

/// The paths of {here}, {bin} and, with [source], {source} and {binary}.
[[nodiscard]] Placeholders folder_placeholders(const ExternalSystem& system);

/// A word of the command with these paths; other placeholders remain.
[[nodiscard]] std::string with_folders(const ExternalSystem& system, std::string word);

/// The program that a word names: a path with a slash is relative to the description.
[[nodiscard]] std::string program_of(const ExternalSystem& system, const std::string& word);

/// Where the program of the command is.
/// @return path of an executable file; empty if there is none in that place or in PATH
[[nodiscard]] std::string find_program(const ExternalSystem& system);

}  // namespace stillpoint::bench
