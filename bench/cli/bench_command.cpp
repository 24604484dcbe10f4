// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/progress.h"
#include "bench/plan/bench_table.h"
#include "bench/plan/plan_runner.h"
#include "bench/record/output_folder.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
  std::string plan;
  std::string out;
};

int exit_code(const std::vector<BenchRow>& rows) {
  if (interrupt_requested()) return kExitInterrupted;
  const bool any_failed =
      std::any_of(rows.begin(), rows.end(), [](const BenchRow& row) { return row.status == "failed"; });
  return any_failed ? kExitFindings : kExitOk;
}

/// Tells what is being done, and how far a rendering is.
PlanHooks hooks() {
  const auto progress = std::make_shared<std::unique_ptr<ProgressLine>>();
  return {.on_step =
              [progress](const std::string& what) {
                progress->reset();
                spdlog::info("{}", what);
              },
          .on_rendered =
              [progress](int done, int total) {
                if (!*progress) {
                  *progress =
                      std::make_unique<ProgressLine>("rendering", static_cast<std::size_t>(total), "frames");
                }
                (*progress)->update(static_cast<std::size_t>(done));
              },
          .stop_requested = interrupt_requested};
}

int bench(const BenchArguments& arguments) {
  watch_interrupts();
  const BenchPlan plan = load_plan(arguments.plan);
  const fs::path out = arguments.out.empty() ? fs::path("build/bench") / fs::path(arguments.plan).stem()
                                             : fs::path(arguments.out);
  require_writable(out);
  const std::vector<BenchRow> rows = run_plan(plan, out, hooks());
  const std::string title =
      plan.title + (interrupt_requested() ? " (interrupted: not every run was made)" : "");
  const std::string table = markdown_table(rows);
  write_files(out, {{"table.md", "# " + title + "\n\n" + table}, {"table.json", json_table(title, rows)}});
  std::cout << title << "\n\n"
            << table << "\nwritten to " << (out / "table.md").string() << " and table.json\n";
  return exit_code(rows);
}

}  // namespace

Command bench_command() {
  const auto arguments = std::make_shared<BenchArguments>();
  return {.name = "bench",
          .summary = "Run a plan of sequences and variants, and print one table of scores and times",
          .example = "bench quick --out /tmp/quick",
          .options = {{"PLAN", "Plan: an embedded name (quick) or a TOML file", &arguments->plan},
                      {"--out", "Folder for the results [build/bench/PLAN]", &arguments->out}},
          .action = [arguments] { return bench(*arguments); },
          .subcommands = {}};
}

}  // namespace stillpoint
