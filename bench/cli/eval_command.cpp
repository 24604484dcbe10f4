// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/record/score_text.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint {
namespace {

struct EvalArguments {
  std::string ground_truth;
  std::string estimate;
  bool json = false;
};

int evaluate(const EvalArguments& arguments) {
  const LoadedTrajectory ground_truth = read_tum(arguments.ground_truth);
  const LoadedTrajectory estimate = read_tum(arguments.estimate);
  const Score result = score(ground_truth.trajectory, estimate.trajectory);
  std::cout << (arguments.json ? score_json(result) : score_text(result));
  return kExitOk;
}

}  // namespace

Command eval_command() {
  const auto arguments = std::make_shared<EvalArguments>();
  return {.name = "eval",
          .summary = "Score a trajectory file (TUM text) against ground truth of the same frame",
          .example = "eval groundtruth.txt trajectory.tum --json",
          .options = {{"GT", "Ground truth", &arguments->ground_truth},
                      {"EST", "Estimate", &arguments->estimate},
                      {"--json", "Print JSON", &arguments->json}},
          .action = [arguments] { return evaluate(*arguments); },
          .subcommands = {}};
}

}  // namespace stillpoint
