// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/commands.h"

namespace stillpoint::bench {

Command data_command() {
  return {.name = "data",
          .summary = "Create and inspect sequences",
          .example = "data synth walking_xyz --out build/walking_xyz",
          .options = {},
          .action = {},
          .subcommands = {check_command(), synth_command(), data_add_command(), data_list_command()}};
}

}  // namespace stillpoint::bench
