// SPDX-License-Identifier: BSD-3-Clause
#include "bench/systems/external_system.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/config/config_file.h"
#include "bench/config/settings.h"
#include "bench/config/spelling.h"
#include "bench/config/toml_source.h"
#include "bench/model/stored_run.h"
#include "bench/process/child_process.h"
#include "bench/systems/module_times.h"
#include "core/base/content_hash.h"
#include "core/base/error.h"
#include "datasets/calibration/rig_yaml_text.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

bool is_name_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

/// Length of the placeholder that begins at the brace, with both braces; 0 if there is none.
std::size_t placeholder_length(std::string_view text) {
  const auto end = std::find_if_not(text.begin() + 1, text.end(), is_name_character);
  const auto length = static_cast<std::size_t>(end - text.begin());
  const bool is_placeholder = end != text.end() && *end == '}' && length > 1 &&
                              std::isdigit(static_cast<unsigned char>(text[1])) == 0;
  return is_placeholder ? length + 1 : 0;
}

std::string text_of(const Setting& setting) {
  if (const auto* text = std::get_if<std::string>(&setting.value)) return *text;
  if (const auto* flag = std::get_if<bool>(&setting.value)) return *flag ? "true" : "false";
  if (const auto* whole = std::get_if<std::int64_t>(&setting.value)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&setting.value)) return fmt::format("{}", *number);
  throw InputError(setting.file, setting.line,
                   "\"" + setting.key + "\" is a list; a parameter is a number, a string, true or false");
}

/// Values for the check of placeholders.
Placeholders placeholder_names(const ExternalSystem& system) {
  Placeholders names;
  for (const char* name : {"sequence", "out", "here", "bin", "seed", "repetition", "speed"}) names[name] = "";
  if (has_calibration(system)) names["calibration"] = "";
  if (!system.source.binary.empty()) names["source"] = names["binary"] = "";
  for (const auto& [name, value] : system.param) names[std::string(kParamPrefix) + name] = value;
  return names;
}

/// As `expanded`; {bin} is not mounted in a container.
void require_text(const ExternalSystem& system, const std::string& text, const std::string& place) {
  static_cast<void>(expanded(text, placeholder_names(system), place));
  if (system.runner != ContainerRunner::kNone && text.find("{bin}") != std::string::npos)
    throw InputError(place,
                     "\"{bin}\" is not in the container; name a program of the image, or remove runner");
}

void require_placeholders(const ExternalSystem& system, const std::vector<Setting>& settings) {
  for (const Setting& setting : settings) {
    const std::string place = fmt::format("{}:{}", setting.file, setting.line);
    const bool has_placeholders = setting.key == "command" || setting.key == "environment" ||
                                  setting.key == "working_folder" || setting.key == "calibration_template";
    if (!has_placeholders) continue;
    if (const auto* text = std::get_if<std::string>(&setting.value)) require_text(system, *text, place);
    if (const auto* texts = std::get_if<std::vector<std::string>>(&setting.value)) {
      for (const std::string& text : *texts) require_text(system, text, place);
    }
  }
}

void require_environment(const Setting& setting, const ExternalSystem& system) {
  for (const std::string& variable : system.environment) {
    if (variable.find('=') != std::string::npos && variable.front() != '=') continue;
    throw InputError(setting.file, setting.line,
                     "\"environment\" contains \"" + variable + "\"; write \"NAME=value\"");
  }
}

void require_calibration(const Setting& setting, const ExternalSystem& system) {
  if (setting.key != "calibration_format") return;
  if (!system.calibration_template.empty())
    throw InputError(setting.file, setting.line,
                     "\"calibration_format\" and calibration_template exclude each other; remove one");
  std::vector<std::string> names;
  for (const auto& [unused, name] : enum_names(datasets::RigFormat{})) names.emplace_back(name);
  if (std::ranges::find(names, system.calibration_format) == names.end())
    throw InputError(setting.file, setting.line,
                     fmt::format("\"calibration_format\" is \"{}\"; expected one of: {}; or write a "
                                 "calibration_template",
                                 system.calibration_format, fmt::join(names, ", ")));
}

void require_image(const ExternalSystem& system) {
  if ((system.runner == ContainerRunner::kNone) == system.image.empty()) return;
  throw InputError(system.path, system.image.empty()
                                    ? "has a runner and no image; add image = \"NAME\" of the container"
                                    : "has an image and no runner; add runner = \"podman\", \"docker\" or "
                                      "\"apptainer\"");
}

void require_source(const ExternalSystem& system, const Setting& setting) {
  if (!setting.key.starts_with("source.")) return;
  const SystemSource& source = system.source;
  if (system.runner != ContainerRunner::kNone)
    throw InputError(
        setting.file, setting.line,
        "[source] is built outside of the container, which runs the program of its image; remove "
        "[source] or runner");
  if (source.binary.empty())
    throw InputError(setting.file, setting.line,
                     "[source] has no binary; add binary = \"PATH\" of the program below the work tree");
  if (fs::path(source.binary).is_absolute())
    throw InputError(setting.file, setting.line, "\"source.binary\" is absolute; it is below the work tree");
  if (source.git.find("://") != std::string::npos)
    throw InputError(setting.file, setting.line,
                     "\"source.git\" is an address; clone it, and state the folder of the clone");
}

/// The name is a key of stored runs and a cell of tables.
void require_name(const ExternalSystem& system, const Setting& setting) {
  if (setting.key != "name") return;
  if (system.name == RunIdentity().system)
    throw InputError(setting.file, setting.line,
                     "\"name\" is \"" + system.name + "\", the odometry of this program; use another name");
  if (std::ranges::any_of(system.name, [](unsigned char c) { return std::iscntrl(c) != 0; }))
    throw InputError(setting.file, setting.line,
                     "\"name\" contains a line break or another control character; remove it");
}

/// @param timing settings of the table [timing]
void apply_timing(ExternalSystem& system, const std::vector<Setting>& timing) {
  for (const Setting& setting : timing) {
    const std::string pattern = text_of(setting);
    if (const std::string problem = is_timing_table(system) ? "" : pattern_problem(pattern); !problem.empty())
      throw InputError(setting.file, setting.line, "\"" + setting.key + "\" " + problem);
    system.timing[setting.key.substr(kTimingPrefix.size())] = pattern;
  }
  if (timing.empty() && system.timing_unit != TimingUnit::kMilliseconds)
    throw InputError(system.path,
                     "has a timing_unit and no table [timing]; remove timing_unit: other times are "
                     "in milliseconds");
}

/// Hash of the contents that determine a run: a rebuilt program or an edited script is another system.
std::string hash_of(const ExternalSystem& system, const std::string& text) {
  std::uint64_t hash = content_hash(text + system.variant.substr(system.name.size()));
  for (const std::string& file : files_of(system)) hash = content_hash(eval::read_text_file(file), hash);
  return hash_text(hash);
}

constexpr std::string_view kVariantPrefix = "variant.";

/// Applies the parameter sets.
/// @param settings of the tables [variant.SET]
void apply_sets(ExternalSystem& system, const std::vector<Setting>& settings,
                const std::vector<std::string>& sets) {
  std::vector<std::string> known;
  for (const Setting& setting : settings) {
    const std::size_t dot = setting.key.find('.', kVariantPrefix.size());
    const std::string param = dot == std::string::npos ? "" : setting.key.substr(dot + 1);
    if (!system.param.contains(param))
      throw InputError(setting.file, setting.line,
                       "\"" + setting.key +
                           "\" sets no parameter of [param]; write [variant.SET] and below it "
                           "a name of [param] with another value");
    known.push_back(setting.key.substr(kVariantPrefix.size(), dot - kVariantPrefix.size()));
  }
  for (const std::string& set : sets) {
    if (std::ranges::find(known, set) == known.end())
      throw InputError(system.path,
                       "has no table [variant." + set + "] with a parameter" + suggestion(set, known));
    const std::string prefix = std::string(kVariantPrefix) + set + ".";
    for (const Setting& setting : settings) {
      if (setting.key.starts_with(prefix)) system.param[setting.key.substr(prefix.size())] = text_of(setting);
    }
    system.variant += "+" + set;
  }
}

/// The paths with {here} or {source} in a command line of a shell, or behind "--option=".
std::vector<std::string> paths_in(const ExternalSystem& system, std::string_view word) {
  constexpr std::string_view kSeparators = " \t\n'\"`=;|&<>(),";
  std::vector<std::string> paths;
  while (!word.empty()) {
    const std::size_t end = std::min(word.find_first_of(kSeparators), word.size());
    const std::string part(word.substr(0, end));
    const bool has_folder =
        part.find("{here}") != std::string::npos || part.find("{source}") != std::string::npos;
    if (has_folder) paths.push_back(with_folders(system, part));
    word.remove_prefix(std::min(end + 1, word.size()));
  }
  return paths;
}

/// The script of an interpreter in PATH, e.g. ["python3", "slam.py"] with a working folder of the system.
/// @return empty if the first argument is no file there
fs::path script_of(const ExternalSystem& system) {
  const bool is_in_path = system.command.front().find('/') == std::string::npos;
  if (!is_in_path || system.working_folder.find("{out}") != std::string::npos) return {};
  const auto argument = std::find_if(system.command.begin() + 1, system.command.end(),
                                     [](const std::string& word) { return !word.starts_with('-'); });
  return argument == system.command.end()
             ? fs::path()
             : fs::path(system.folder) / with_folders(system, system.working_folder) / *argument;
}

}  // namespace

// Programs of PATH belong to the machine; a file without {here}, {bin} or {source} may be an output.
std::vector<std::string> files_of(const ExternalSystem& system) {
  std::vector<std::string> files;
  const auto add_file = [&files](const fs::path& file) {
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) files.push_back(file.string());
  };
  if (!system.calibration_template.empty()) add_file(fs::path(system.folder) / system.calibration_template);
  for (const std::string& word : system.command) {
    const bool is_program = &word == &system.command.front();
    const std::string path = with_folders(system, word);
    const std::string program = program_of(system, path);
    const bool is_in_image = system.runner != ContainerRunner::kNone && path_below(system, program).empty();
    if (is_program && path.find('/') != std::string::npos && !is_in_image) add_file(program);
    if (!is_program && path != word) add_file(path);
    if (std::error_code ignored; !is_program && !fs::is_regular_file(path, ignored))
      std::ranges::for_each(paths_in(system, word), add_file);
  }
  if (system.runner == ContainerRunner::kNone) add_file(script_of(system));
  return files;
}

std::string path_below(const ExternalSystem& system, const std::string& file) {
  const fs::path folder = fs::path(system.folder).lexically_normal();
  const fs::path relative = fs::path(file).lexically_normal().lexically_relative(folder);
  return relative.empty() || *relative.begin() == ".." ? "" : relative.string();
}

bool has_calibration(const ExternalSystem& system) {
  return !system.calibration_template.empty() || !system.calibration_format.empty();
}

bool is_timing_table(const ExternalSystem& system) { return fs::path(system.timings).extension() == ".csv"; }

SystemName parse_system_name(std::string name) {
  SystemName result;
  const auto is_set = [](std::string_view text) {
    return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_' || c == '-';
    });
  };
  for (std::size_t plus = name.rfind('+'); plus != std::string::npos && is_set(name.substr(plus + 1));
       plus = name.rfind('+')) {
    result.sets.insert(result.sets.begin(), name.substr(plus + 1));
    name.resize(plus);
  }
  result.file = std::move(name);
  return result;
}

std::string expanded(std::string_view text, const Placeholders& values, const std::string& place) {
  std::string result;
  while (!text.empty()) {
    const std::size_t brace = std::min(text.find('{'), text.size());
    result += text.substr(0, brace);
    text.remove_prefix(brace);
    if (text.empty()) break;
    const std::size_t length = placeholder_length(text);
    if (length == 0) {
      result += '{';
      text.remove_prefix(1);
      continue;
    }
    const std::string name(text.substr(1, length - 2));
    const auto value = values.find(name);
    if (value == values.end()) {
      std::vector<std::string> names;
      for (const auto& [known, unused] : values) names.push_back(known);
      const std::string near = suggestion(name, names);
      const std::string remedy = name == "calibration" ? "; set calibration_format or calibration_template"
                                 : name.starts_with("param.") ? "; add it to the table [param]"
                                 : name == "source" || name == "binary"
                                     ? "; add the table [source] with the key binary"
                                 : near.empty() ? fmt::format("; expected one of: {}", fmt::join(names, ", "))
                                                : near;
      throw InputError(place, fmt::format("\"{{{}}}\" is no placeholder{}", name, remedy));
    }
    result += value->second;
    text.remove_prefix(length);
  }
  return result;
}

ExternalSystem parse_external_system(const std::string& text, const std::string& path,
                                     const std::vector<std::string>& sets) {
  ExternalSystem system;
  std::vector<Setting> own_settings;
  std::vector<Setting> set_settings;
  std::vector<Setting> timing_settings;
  for (const Setting& setting : parse_settings(text, path)) {
    if (setting.key.starts_with(kParamPrefix)) {
      system.param[setting.key.substr(kParamPrefix.size())] = text_of(setting);
    } else if (setting.key.starts_with(kVariantPrefix)) {
      set_settings.push_back(setting);
    } else if (setting.key.starts_with(kTimingPrefix)) {
      timing_settings.push_back(setting);
    } else {
      own_settings.push_back(setting);
    }
  }
  system = with_settings(std::move(system), own_settings);
  if (system.name.empty()) throw InputError(path, "has no name; add name = \"...\"");
  if (system.command.empty()) throw InputError(path, "has no command; add command = [\"program\", ...]");
  require_placeholders(system, own_settings);
  for (const Setting& setting : own_settings) {
    require_name(system, setting);
    if (setting.key == "environment") require_environment(setting, system);
    require_calibration(setting, system);
    require_source(system, setting);
    const bool is_template = setting.key == "calibration_template";
    const fs::path file = fs::absolute(path).parent_path() / system.calibration_template;
    if (is_template && !fs::is_regular_file(file))
      throw InputError(path, setting.line,
                       "\"calibration_template\": " + file.string() +
                           " does not exist; write the calibration "
                           "file of the system there, with placeholders such as {fx}");
  }
  system.text = text;
  system.path = path;
  require_image(system);
  apply_timing(system, timing_settings);
  system.variant = system.name;
  apply_sets(system, set_settings, sets);
  system.folder = fs::absolute(path).parent_path().string();
  system.hash_without_source = hash_of(system, text);
  if (!system.source.binary.empty())
    system.source_folder = (fs::path(system.folder) / system.source.git).lexically_normal().string();
  system.hash = hash_of(system, text);
  return system;
}

ExternalSystem load_external_system(const std::string& name) {
  const SystemName parsed = parse_system_name(name);
  const TomlSource source = find_toml(parsed.file, TomlKind::kSystem);
  // An embedded description has no folder; the programs that it names are beside this one.
  if (!source.embedded) return parse_external_system(source.text, source.path, parsed.sets);
  ExternalSystem system = parse_external_system(
      source.text, executable_path().parent_path() / fs::path(source.path).filename(), parsed.sets);
  system.path = source.path;
  return system;
}

bool is_description(const std::string& name) {
  const std::string file = parse_system_name(name).file;
  if (std::ranges::count(embedded_names(TomlKind::kSystem), file) > 0) return true;
  if (!file.ends_with(".toml") || !fs::is_regular_file(file)) return false;
  return std::ranges::any_of(parse_settings(eval::read_text_file(file), file),
                             [](const Setting& setting) { return setting.key == "command"; });
}

std::vector<DifferentKey> different_keys(const ExternalSystem& a, const ExternalSystem& b) {
  ExternalSystem copy_a = a;
  ExternalSystem copy_b = b;
  std::vector<DifferentKey> keys = different_keys(fields_of(copy_a), fields_of(copy_b));
  const auto add = [&keys](std::string_view prefix, std::map<std::string, std::string> values_a,
                           std::map<std::string, std::string> values_b) {
    for (const auto& [name, unused] : values_b) values_a.try_emplace(name);
    for (const auto& [name, value] : values_a) {
      if (value != values_b[name]) keys.push_back({std::string(prefix) + name, value, values_b[name], ""});
    }
  };
  add(kParamPrefix, a.param, b.param);
  add(kTimingPrefix, a.timing, b.timing);
  return keys;
}

namespace {

constexpr const char* kDescription =
    R"(# Description of a SLAM system for stillpoint; manual: bench/README.md, "Any system".
# Keys that are commented out show their defaults. Try it: stillpoint systems check FILE
name = {}
version = "1"                     # of the program; runs of another version are another build

# The program and its arguments; no shell. A program with a slash is relative to this file. Placeholders:
# {{sequence}} what it reads, {{out}} its empty output folder, {{here}} the folder of this file, {{seed}},
# {{repetition}}, {{calibration}}, {{param.NAME}}
command = ["./my_slam", "{{sequence}}", "{{out}}/trajectory.tum"]
# working_folder = "{{out}}"        # or a folder relative to this file
# environment = []                # e.g. ["OMP_NUM_THREADS=1"]

# What {{sequence}} is: "tum" (rgb.txt, depth.txt, imu.txt, rig.toml), "euroc" (mav0/cam0, mav0/imu0),
# "bag" (ROS 1), "mcap" (ROS 2), or "as_is" (the folder of the sequence, whatever its format)
layout = "tum"

# The calibration as {{calibration}}, a file in {{out}}: in the format of "kalibr", "openvins", "opencv" (also RTAB-Map),
# "orb_slam" (ORB-SLAM3), "vins" or "toml"
# calibration_format = "opencv"
# or by a text file beside this one, with placeholders such as {{fx}} {{fy}} {{cx}} {{cy}} {{width}} {{height}} {{k1}} {{T_b_c}}
# {{depth_units_per_m}} {{fps}} {{gyro_noise}}; a setting may be {{param.NAME}}
# calibration_template = "camera.yaml.in"
# calibration_file = "calibration.yaml"

# What the program writes: a file in {{out}} as "tum" (t x y z qx qy qz qw), "euroc", or "kitti" (one matrix per
# image); poses of the "camera" or of the "body" (IMU) in the world; inverse = true if they are world in camera
trajectory = "trajectory.tum"
# trajectory_format = "tum"
# poses = "camera"
# inverse = false
# scale = "metric"                # "unknown": a monocular system; its scale is fitted to the ground truth

# Times of its modules, a file in {{out}}: JSON {{"modules": {{"tracking": [3.1, 2.9]}}}} with milliseconds per call;
# CSV with columns such as tracking_ms; with [timing], other columns or lines of text (without timings: what it prints)
# timings = "timings.json"
# timing_unit = "ms"              # or s, us, ns: of [timing]

# The program is in a container: "podman", "docker" or "apptainer"; {{sequence}} and {{here}} are read-only in it
# runner = "podman"
# image = "localhost/my_slam:1"
# runner_options = []

# For `stillpoint history`, `bisect` and `compare FILE@COMMIT`: the repository of the program, the command that
# builds a commit in its work tree, and the result, which is {{binary}} in the command; {{source}} is the work tree
# [source]
# git = "."
# build = ["sh", "-c", "cmake -B build && cmake --build build"]
# binary = "build/my_slam"

# Values of {{param.NAME}}; a plan varies them by [sweep] param.NAME = [500, 1000]
[param]
# features = 1000

# Times by MODULE = column of timings = "FILE.csv", or pattern of lines with one group
# [timing]
# tracking = 'tracking took ([0-9.]+) ms'

# A parameter set: FILE+few names a variant of the system, for `stats ablation` and comparisons
# [variant.few]
# features = 300
)";

}  // namespace

std::string description_template(const std::string& name) {
  return fmt::format(kDescription, toml_quoted(name));
}

Placeholders calibration_placeholders(const Rig& rig, const SensorRates& rates) {
  // OpenCV's reader of YAML distinguishes reals, which have a decimal point, from integers.
  const auto number = [](double value) { return fmt::format("{:#}", value); };
  const auto matrix = [](const Pose& pose) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
    return fmt::format("{:#}", fmt::join(rows.data(), rows.data() + 16, ", "));
  };
  const Camera& camera = rig.camera;
  const bool is_fisheye = camera.model == CameraModel::kKannalaBrandt;
  Placeholders values = {{"fx", number(camera.fx)},
                         {"fy", number(camera.fy)},
                         {"cx", number(camera.cx)},
                         {"cy", number(camera.cy)},
                         {"width", fmt::format("{}", camera.width)},
                         {"height", fmt::format("{}", camera.height)},
                         {"model", is_fisheye ? "kannala-brandt" : "radial-tangential"},
                         {"k1", number(camera.distortion[0])},
                         {"k2", number(camera.distortion[1])},
                         {"fps", fmt::format("{:.0f}", rates.frames_per_s)},
                         {"depth_units_per_m", number(rig.depth_units_per_m)},
                         {"T_b_c", matrix(rig.T_b_c)},
                         {"T_c_b", matrix(rig.T_b_c.inverse())},
                         {"gyro_noise", number(rig.imu_noise.gyro_noise)},
                         {"accel_noise", number(rig.imu_noise.accel_noise)},
                         {"gyro_walk", number(rig.imu_noise.gyro_walk)},
                         {"accel_walk", number(rig.imu_noise.accel_walk)},
                         {"imu_rate", number(rates.imu_hz)},
                         {"time_offset_s", number(rig.time_offset_s)}};
  const std::vector<const char*> others =
      is_fisheye ? std::vector{"k3", "k4"} : std::vector{"p1", "p2", "k3", "k4", "k5", "k6"};
  for (std::size_t i = 0; i < others.size(); ++i) values[others[i]] = number(camera.distortion[i + 2]);
  return values;
}

Placeholders folder_placeholders(const ExternalSystem& system) {
  Placeholders folders = {{"here", system.folder}, {"bin", executable_path().parent_path().string()}};
  if (!system.source_folder.empty()) {
    folders["source"] = system.source_folder;
    folders["binary"] = (fs::path(system.source_folder) / system.source.binary).string();
  }
  return folders;
}

std::string with_folders(const ExternalSystem& system, std::string word) {
  for (const auto& [name, folder] : folder_placeholders(system)) {
    const std::string placeholder = "{" + name + "}";
    const std::size_t at = word.find(placeholder);
    if (at != std::string::npos) word.replace(at, placeholder.size(), folder);
  }
  return word;
}

std::string program_of(const ExternalSystem& system, const std::string& word) {
  const bool is_path = word.find('/') != std::string::npos;
  return is_path ? (fs::path(system.folder) / word).lexically_normal().string() : word;
}

std::string find_program(const ExternalSystem& system) {
  const auto is_executable = [](const fs::path& file) {
    std::error_code ignored;
    return fs::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0;
  };
  std::string program = program_of(system, with_folders(system, system.command.front()));
  for (const auto& [runner, name] : enum_names(system.runner)) {
    if (runner == system.runner && runner != ContainerRunner::kNone) program = name;
  }
  if (program.find('/') != std::string::npos) return is_executable(program) ? program : "";
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "/usr/bin:/bin" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path file = fs::path(folder) / program;
    if (is_executable(file)) return file.string();
  }
  return "";
}

}  // namespace stillpoint::bench
