// SPDX-License-Identifier: BSD-3-Clause
/// The subcommands of the program, one source file each (`run` in run_command.cpp and so on).
#pragma once

#include "bench/cli/command.h"

namespace stillpoint {

[[nodiscard]] Command run_command();             ///< `stillpoint run`: odometry over one sequence
[[nodiscard]] Command eval_command();            ///< `stillpoint eval`: scores of a trajectory file
[[nodiscard]] Command eval_openloris_command();  ///< `stillpoint eval openloris`: result files by scene
[[nodiscard]] Command bench_command();           ///< `stillpoint bench`: sequences x variants, one table
[[nodiscard]] Command plan_command();            ///< `stillpoint plan`: what plans ask for
[[nodiscard]] Command store_command();           ///< `stillpoint store`: looking after stores of runs
/// `stillpoint store accept`, `withdraw` and `accepted`: changes of numbers that people accept
[[nodiscard]] std::vector<Command> acceptance_commands();
[[nodiscard]] Command stats_command();        ///< `stillpoint stats`: what runs say together
[[nodiscard]] Command compare_command();      ///< `stillpoint compare`: the gate for commits
[[nodiscard]] Command profile_command();      ///< `stillpoint profile`: where the time of a run goes
[[nodiscard]] Command report_command();       ///< `stillpoint report`: one offline page about a store
[[nodiscard]] Command dashboard_command();    ///< `stillpoint dashboard`: numbers over commits as pages
[[nodiscard]] Command regressions_command();  ///< `stillpoint regressions`: what is worse and not accepted
[[nodiscard]] Command serve_command();  ///< `stillpoint serve`: the dashboard for browsers on this machine
[[nodiscard]] Command reproduce_command();  ///< `stillpoint reproduce`: a table of the paper in one command
[[nodiscard]] Command config_command();     ///< `stillpoint config`: resolved configs and the reference page
[[nodiscard]] Command data_command();       ///< `stillpoint data`: make and inspect sequences
[[nodiscard]] Command check_command();      ///< `stillpoint data check`: the sequence doctor
[[nodiscard]] Command data_add_command();   ///< `stillpoint data add`: names for recorded sequences
[[nodiscard]] Command data_list_command();  ///< `stillpoint data list`
[[nodiscard]] Command detect_command();     ///< `stillpoint detect`: boxes of a network, recorded
[[nodiscard]] Command synth_command();      ///< `stillpoint data synth`: render a sequence

}  // namespace stillpoint
