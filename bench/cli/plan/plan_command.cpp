// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/config/toml_source.h"
#include "bench/plan/plan_matrix.h"
#include "bench/systems/own_odometry.h"

namespace stillpoint::bench {
namespace {

int list() {
  for (const std::string& name : embedded_names(TomlKind::kPlan)) {
    std::cout << fmt::format("{:<32} {}\n", name, load_plan(name).title);
  }
  return kExitOk;
}

int show(const std::string& name) {
  const PlanMatrix matrix = expand_plan(load_plan(name), build_name(), {});
  std::cout << matrix.plan.title << "\n\n";
  for (const PlannedRun& run : matrix.runs) {
    const std::string& missing = matrix.sequences[run.sequence].unavailable_reason;
    std::cout << run_key(run.identity) << "  " << run_label(matrix.plan, run.identity)
              << (missing.empty() ? "" : "  (not available)") << '\n';
  }
  std::cout << fmt::format("{} runs of {} sequences\n", matrix.runs.size(), matrix.sequences.size());
  return kExitOk;
}

}  // namespace

Command plan_command() {
  const auto name = std::make_shared<std::string>();
  return {
      .name = "plan",
      .summary = "List plans and their runs",
      .example = "plan show quick",
      .subcommands = {
          {.name = "show",
           .summary = "List all runs of a plan with their keys",
           .example = "plan show quick",
           .options = {{"PLAN", "Plan: an embedded name or a TOML file", name.get()}},
           .action = [name] { return show(*name); }},
          {.name = "list", .summary = "List the embedded plans", .example = "plan list", .action = list}}};
}

}  // namespace stillpoint::bench
