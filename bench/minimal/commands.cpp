// SPDX-License-Identifier: BSD-3-Clause
// The commands of the minimal build.
#include "bench/cli/command_line.h"

namespace stillpoint::bench {

std::vector<Command> all_commands() {
  return {run_command(),  eval_command(),   config_command(),
          data_command(), device_command(), version_command()};
}

Command data_command() {
  return {.name = "data",
          .summary = "Inspect sequences",
          .example = "data check my_sequence",
          .subcommands = {check_command(), faults_command()}};
}

}  // namespace stillpoint::bench
