// SPDX-License-Identifier: BSD-3-Clause
/// The command line: declarative description of the subcommands and their options, parsing, and selection of
/// one. Names are checked before the words are parsed, to suggest the nearest one. The subcommands of the
/// program have one source file each (`run` in run_command.cpp etc.).
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/error.h"
#include "core/base/fields.h"

namespace stillpoint::bench {

/// Destination of an option's value; its type determines the accepted values. A bool is a flag without a
/// value, a vector is an option that may be repeated.
using OptionTarget = std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*>;

/// Range of the values of a number option. Both ends are allowed. The default admits every number that a
/// command can compute with; nan and inf never are in a range.
struct NumberRange {
  double least = -1e9;
  double most = 1e9;
};

/// An option (`--out`) or, when its name does not begin with a dash, a required argument (`SEQ`).
struct Option {
  std::string name;
  std::string help;
  OptionTarget target;
  NumberRange range = {};         ///< of a number option
  std::string hidden_alias = {};  ///< former name of a vector option; accepted, not listed by --help
  int values = 1;                 ///< > 1: number of values of a vector option, which is then not repeated
  bool may_be_omitted = false;    ///< of an argument
  std::string argument = {};      ///< an option's name as an argument: STORE instead of --store STORE
};

/// The store that a command reads, as an argument or as an option.
[[nodiscard]] Option store_option(std::string* store);

/// A subcommand. `action` owns the option targets, usually through a captured shared_ptr to a struct.
struct Command {
  std::string name;
  std::string summary;  ///< one line
  std::string example;  ///< a valid command line, without the program name
  std::vector<Option> options = {};
  std::function<int()> action = {};  ///< called after parsing if no subcommand was given; returns the exit
                                     ///< code. May be empty for commands that require a subcommand
  std::vector<Command> subcommands = {};
};

/// Exit codes of the program.
inline constexpr int kExitOk = 0;
inline constexpr int kExitFindings = 1;       ///< completed, but the result is negative, e.g. a failed run
inline constexpr int kExitBadInput = 2;       ///< invalid usage or input; one error line was printed
inline constexpr int kExitInconclusive = 3;   ///< completed, but the data do not allow a statement
inline constexpr int kExitInternal = 70;      ///< a bug in the program, or out of memory; EX_SOFTWARE
inline constexpr int kExitInterrupted = 130;  ///< 128 + SIGINT, as shells report it

/// Sets the options and the log level. @return the action of the selected command; after --help or --version,
/// whose text is printed, one that does nothing
/// @throws InputError for invalid usage
[[nodiscard]] std::function<int()> parse_command_line(int argc, char** argv,
                                                      const std::vector<Command>& commands);

/// Prints the exception that is being handled to stderr: one line for an InputError.
/// @return the exit code: `kExitBadInput` or `kExitInternal`
[[nodiscard]] int report_exception();

/// Help of the option --rig.
inline constexpr const char* kRigHelp =
    "Calibration that overrides that of the sequence: rig.toml, or YAML of Kalibr, OpenCV, ROS, ORB-SLAM, "
    "VINS";

/// Message before `SourceBuilds::build`, if it is busy.
inline constexpr const char* kWaitForBuild =
    "wait for another history, bisect or compare, which builds a commit of this repository";

/// Help of the option --builds.
inline constexpr const char* kBuildsHelp =
    "Folder of work trees and builds of commits, which are kept [builds/ in the cache folder]";

/// Help of the option --topics, of which the values are passed to `OpenOptions::topics`.
inline constexpr const char* kTopicsHelp =
    "Topic of a bag: ROLE=TOPIC, with a role color, depth, imu, gyro, accel or truth; may be repeated [by "
    "type and "
    "name]";

/// Help of the option --sysfs-root.
inline constexpr const char* kSysfsRootHelp =
    "Folder with recorded sys, proc, etc and var instead of those of this machine [/]";

/// The subcommands of this build of the program: commands.cpp, or bench/minimal/commands.cpp.
[[nodiscard]] std::vector<Command> all_commands();

[[nodiscard]] Command run_command();             ///< `stillpoint run`: odometry on one sequence
[[nodiscard]] Command calibrate_command();       ///< `stillpoint calibrate`: calibration from a recording
[[nodiscard]] Command diagnose_command();        ///< `stillpoint diagnose`: what limits a recording
[[nodiscard]] Command eval_command();            ///< `stillpoint eval`: score trajectory files
[[nodiscard]] Command eval_openloris_command();  ///< `stillpoint eval openloris`: result files by scene
[[nodiscard]] Command trajectory_command();      ///< `stillpoint trajectory`: convert and change files
[[nodiscard]] Command eval_cloud_command();      ///< `stillpoint eval cloud`: compare point clouds
[[nodiscard]] Command find_protocol_command();   ///< `stillpoint eval find-protocol`: of a published number
[[nodiscard]] Command bench_command();           ///< `stillpoint bench`: execute a benchmark plan
[[nodiscard]] Command worker_command();          ///< `stillpoint worker`: execute tasks of a plan
[[nodiscard]] Command systems_command();         ///< `stillpoint systems`: describe and try other systems
[[nodiscard]] Command system_run_command();      ///< `stillpoint systems run`: a system on one sequence
[[nodiscard]] Command plan_command();            ///< `stillpoint plan`: list plans and their runs
[[nodiscard]] Command store_command();           ///< `stillpoint store`: inspect and maintain stores
[[nodiscard]] Command stats_command();           ///< `stillpoint stats`: statistics over runs
[[nodiscard]] Command compare_command();         ///< `stillpoint compare`: regression gate
[[nodiscard]] Command history_command();         ///< `stillpoint history`: measure a range of commits
[[nodiscard]] Command bisect_command();          ///< `stillpoint bisect`: the commit that changed a metric
[[nodiscard]] Command profile_command();         ///< `stillpoint profile`: profile one run
[[nodiscard]] Command report_command();          ///< `stillpoint report`: HTML report of a store
[[nodiscard]] Command dashboard_command();       ///< `stillpoint dashboard`: metrics over commits as HTML
[[nodiscard]] Command regressions_command();     ///< `stillpoint regressions`: list open regressions
[[nodiscard]] Command serve_command();           ///< `stillpoint serve`: serve the dashboard over HTTP
[[nodiscard]] Command reproduce_command();       ///< `stillpoint reproduce`: tables of the paper
[[nodiscard]] Command config_command();     ///< `stillpoint config`: resolved configs and the key reference
[[nodiscard]] Command data_command();       ///< `stillpoint data`: create and inspect sequences
[[nodiscard]] Command catalogue_command();  ///< `stillpoint data catalogue`: list public datasets
[[nodiscard]] Command get_command();        ///< `stillpoint data get`: download sequences
[[nodiscard]] Command verify_command();     ///< `stillpoint data verify`: compare files with their digests
[[nodiscard]] Command cache_command();      ///< `stillpoint data cache`: decoded frames on disk
[[nodiscard]] Command cloud_command();      ///< `stillpoint data cloud`: point cloud by the ground truth
[[nodiscard]] Command check_command();      ///< `stillpoint data check`: validate a sequence
[[nodiscard]] Command faults_command();     ///< `stillpoint data faults`: list injectable sensor faults
[[nodiscard]] Command export_command();     ///< `stillpoint data export`: write other layouts
[[nodiscard]] Command device_command();     ///< `stillpoint device`: cores, temperatures, power rails
[[nodiscard]] Command detect_command();     ///< `stillpoint detect`: record boxes of a detection network
[[nodiscard]] Command version_command();    ///< `stillpoint version`: the build of the program
[[nodiscard]] Command synth_command();      ///< `stillpoint data synth`: render a sequence

/// The accepted values, e.g. "none, first_pose, yaw".
template <class Enum>
[[nodiscard]] std::string enum_list() {
  std::string list;
  for (const auto& [value, name] : enum_names(Enum{})) list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

/// The value with the given name.
/// @throws InputError naming the option and the accepted values
template <class Enum>
[[nodiscard]] Enum enum_of(const std::string& option, const std::string& name) {
  for (const auto& [value, known] : enum_names(Enum{})) {
    if (known == name) return value;
  }
  throw InputError(option, "unknown value \"" + name + "\"; expected one of: " + enum_list<Enum>());
}

}  // namespace stillpoint::bench
