// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/plan_hooks.h"
#include "bench/plan/bench_table.h"
#include "bench/plan/plan_runner.h"
#include "bench/record/output_folder.h"
#include "bench/systems/own_odometry.h"
#include "bench/systems/published_table.h"
#include "core/base/error.h"
#include "reports/beside_published.h"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
  std::string plan;
  std::string store = "build/bench/store.sqlite";
  std::string out;
  int jobs = 1;
  std::vector<std::string> filters;
  bool dry_run = false;
  bool retry = false;
};

int exit_code(const std::vector<BenchRow>& rows) {
  if (interrupt_requested()) return kExitInterrupted;
  const bool all_well = std::all_of(rows.begin(), rows.end(), [](const BenchRow& row) {
    return row.status == "ok" || row.status == "skipped";
  });
  return all_well ? kExitOk : kExitFindings;
}

/// Lists the runs and whether the store has them; makes nothing, not even a store.
int dry_run(const PlanMatrix& matrix, const fs::path& store) {
  std::vector<std::string> done;
  if (fs::exists(store)) {
    for (const StoredRun& run : Store(store).runs()) done.push_back(run.key);
  }
  std::size_t missing = 0;
  for (const PlannedRun& run : matrix.runs) {
    const bool is_done = std::find(done.begin(), done.end(), run_key(run.identity)) != done.end();
    const bool at_hand = matrix.sequences[run.sequence].missing.empty();
    missing += is_done ? 0 : 1;
    std::cout << fmt::format("{}  {}\n",
                             is_done   ? "done   "
                             : at_hand ? "to make"
                                       : "skipped",
                             run_label(matrix.plan, run.identity));
  }
  std::cout << fmt::format("{} of {} runs are done\n", matrix.runs.size() - missing, matrix.runs.size());
  return kExitOk;
}

/// The tables of published numbers that the plan names, beside the runs of the plan.
std::string published_text(const PlanMatrix& matrix, const Store& store) {
  std::string text;
  const std::vector<StoredRun> runs = store.plan_runs(matrix.plan.name);
  for (const std::string& name : matrix.plan.table.published) {
    const std::string table = beside_published(runs, load_published(name));
    if (!table.empty()) text += "\n" + table;
  }
  return text;
}

void print_rows(const PlanMatrix& matrix, const std::vector<BenchRow>& rows, const std::string& beside,
                const fs::path& out) {
  const std::string title =
      matrix.plan.title + (interrupt_requested() ? " (interrupted: not every run was made)" : "");
  const std::string table = markdown_table(rows) + beside;
  write_files(out, {{"table.md", "# " + title + "\n\n" + table}, {"table.json", json_table(title, rows)}});
  std::cout << title << "\n\n"
            << table << "\nwritten to " << (out / "table.md").string() << " and table.json\n";
}

int bench(const BenchArguments& arguments) {
  if (arguments.jobs < 1) throw InputError("--jobs", "must be at least 1");
  watch_interrupts();
  const PlanMatrix matrix = expand_plan(load_plan(arguments.plan), build_name(), arguments.filters);
  if (matrix.runs.empty())
    throw InputError("--filter", "leaves no run of the plan; see `stillpoint plan show`");
  if (arguments.dry_run) return dry_run(matrix, arguments.store);
  const fs::path out =
      arguments.out.empty() ? fs::path("build/bench") / matrix.plan.name : fs::path(arguments.out);
  require_writable(out);
  PlanReport report;
  {
    Journal journal(arguments.store);
    report = run_plan(matrix, journal, {.jobs = arguments.jobs, .retry = arguments.retry}, plan_hooks());
  }
  const Store store(arguments.store);
  const std::vector<BenchRow> rows = plan_rows(matrix, store);
  print_rows(matrix, rows, published_text(matrix, store), out);
  std::cout << fmt::format("{} runs made, {} were there; store {}\n", report.made, report.kept,
                           arguments.store);
  return exit_code(rows);
}

}  // namespace

Command bench_command() {
  const auto arguments = std::make_shared<BenchArguments>();
  return {
      .name = "bench",
      .summary = "Make the runs of a plan that the store lacks, and print one table of scores and times",
      .example = "bench quick --store /tmp/store.sqlite --jobs 2",
      .options = {{"PLAN", "Plan: an embedded name (quick) or a TOML file", &arguments->plan},
                  {"--store", "File that keeps the runs [build/bench/store.sqlite]", &arguments->store},
                  {"--out", "Folder for the table [build/bench/PLAN]", &arguments->out},
                  {"--jobs", "Accuracy runs at a time", &arguments->jobs},
                  {"--filter",
                   "Only runs whose sequence, variant or system matches this glob; may be repeated",
                   &arguments->filters},
                  {"--dry-run", "List the runs and whether they are done; make none", &arguments->dry_run},
                  {"--retry", "Make runs again that did not end well", &arguments->retry}},
      .action = [arguments] { return bench(*arguments); },
      .subcommands = {}};
}

}  // namespace stillpoint
