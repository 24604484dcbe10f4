// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/command_line.h"

namespace stillpoint::bench {

std::vector<Command> all_commands() {
  return {
      run_command(),       eval_command(),        bench_command(),   worker_command(),     plan_command(),
      store_command(),     stats_command(),       compare_command(), profile_command(),    report_command(),
      dashboard_command(), regressions_command(), serve_command(),   reproduce_command(),  detect_command(),
      config_command(),    data_command(),        device_command(),  calibrate_command(),  systems_command(),
      diagnose_command(),  history_command(),     bisect_command(),  trajectory_command(), version_command()};
}

}  // namespace stillpoint::bench
