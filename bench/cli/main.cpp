// SPDX-License-Identifier: BSD-3-Clause
/// The program `stillpoint`.
#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/process_streams.h"

int main(int argc, char** argv) {
  using namespace stillpoint::bench;
  prepare_process();
  return finish_output(
      run_command_line(argc, argv,
                       {run_command(), eval_command(), bench_command(), worker_command(), plan_command(),
                        store_command(), stats_command(), compare_command(), profile_command(),
                        report_command(), dashboard_command(), regressions_command(), serve_command(),
                        reproduce_command(), detect_command(), config_command(), data_command()}));
}
