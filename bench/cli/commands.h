// SPDX-License-Identifier: BSD-3-Clause
/// The subcommands of the program, one source file each (`run` in run_command.cpp etc.).
#pragma once

#include "bench/cli/command_line.h"

namespace stillpoint::bench {

/// Help of the option --topics, of which the values are passed to `OpenOptions::topics`.
inline constexpr const char* kTopicsHelp =
    "Topic of a bag: ROLE=TOPIC, with a role color, depth, imu, gyro, accel or truth; may be repeated [by "
    "type and "
    "name]";

/// Help of the option --sysfs-root.
inline constexpr const char* kSysfsRootHelp =
    "Folder with recorded sys, proc, etc and var instead of those of this machine [/]";

[[nodiscard]] Command run_command();             ///< `stillpoint run`: odometry on one sequence
[[nodiscard]] Command eval_command();            ///< `stillpoint eval`: score trajectory files
[[nodiscard]] Command eval_openloris_command();  ///< `stillpoint eval openloris`: score result files by scene
[[nodiscard]] Command bench_command();           ///< `stillpoint bench`: execute a benchmark plan
[[nodiscard]] Command worker_command();          ///< `stillpoint worker`: execute tasks of a plan
[[nodiscard]] Command plan_command();            ///< `stillpoint plan`: list plans and their runs
[[nodiscard]] Command store_command();           ///< `stillpoint store`: inspect and maintain stores
/// `stillpoint store accept`, `withdraw` and `accepted`: accepted metric changes
[[nodiscard]] std::vector<Command> acceptance_commands();
[[nodiscard]] Command stats_command();        ///< `stillpoint stats`: statistics over runs
[[nodiscard]] Command compare_command();      ///< `stillpoint compare`: regression gate
[[nodiscard]] Command profile_command();      ///< `stillpoint profile`: profile one run
[[nodiscard]] Command report_command();       ///< `stillpoint report`: HTML report of a store
[[nodiscard]] Command dashboard_command();    ///< `stillpoint dashboard`: metrics over commits as HTML
[[nodiscard]] Command regressions_command();  ///< `stillpoint regressions`: list open regressions
[[nodiscard]] Command serve_command();        ///< `stillpoint serve`: serve the dashboard over HTTP
[[nodiscard]] Command reproduce_command();    ///< `stillpoint reproduce`: tables of the paper
[[nodiscard]] Command config_command();       ///< `stillpoint config`: resolved configs and the key reference
[[nodiscard]] Command data_command();         ///< `stillpoint data`: create and inspect sequences
[[nodiscard]] Command catalogue_command();    ///< `stillpoint data catalogue`: list public datasets
[[nodiscard]] Command get_command();          ///< `stillpoint data get`: download sequences
[[nodiscard]] Command verify_command();       ///< `stillpoint data verify`: compare files with their digests
[[nodiscard]] Command cache_command();        ///< `stillpoint data cache`: decoded frames on disk
[[nodiscard]] Command check_command();        ///< `stillpoint data check`: validate a sequence
[[nodiscard]] Command faults_command();       ///< `stillpoint data faults`: list injectable sensor faults
[[nodiscard]] Command export_command();       ///< `stillpoint data export`: write other layouts
[[nodiscard]] Command device_command();       ///< `stillpoint device`: cores, temperatures, power rails
[[nodiscard]] Command detect_command();       ///< `stillpoint detect`: record boxes of a detection network
[[nodiscard]] Command synth_command();        ///< `stillpoint data synth`: render a sequence

}  // namespace stillpoint::bench
