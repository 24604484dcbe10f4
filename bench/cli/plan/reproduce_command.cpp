// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/cli/plan/plan_progress.h"
#include "bench/record/output_folder.h"
#include "bench/record/output_guard.h"
#include "bench/systems/own_odometry.h"
#include "core/base/error.h"
#include "reports/page/report_page.h"
#include "reports/tables/formats/table_formats.h"
#include "reports/tables/paper_tables.h"
#include "reports/tables/result_tables.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

struct ReproduceArguments {
  std::string target;
  std::string store = "build/bench/reproduce.sqlite";
  std::string out = "build/reproduce";
  bool synthetic = false;
  bool real = false;
  int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

/// A table or figure of the paper, and the plans that reproduce it.
struct Target {
  const char* name;
  const char* synthetic_plan;
  const char* real_plan;  ///< empty = none
  const char* real_data;  ///< required data set, and how to obtain it
};
constexpr const char* kTumData =
    "the fr3_walking sequences of the TUM RGB-D dataset; unpack them and register each one with `stillpoint "
    "data "
    "add walking_xyz DIR`";
constexpr const char* kOpenlorisData =
    "the OpenLORIS-Scene recordings, which are available on request; run `stillpoint run` on each, and "
    "`stillpoint "
    "eval openloris` on the results";
constexpr Target kTargets[] = {{"table1", "table1_tum_synthetic", "table1_tum", kTumData},
                               {"table2", "table2_ablation_synthetic", "table2_ablation", kTumData},
                               {"table3", "table3_runtime", "", kOpenlorisData},
                               {"openloris", "openloris_synthetic", "", kOpenlorisData}};

std::vector<Target> select_targets(const std::string& name) {
  std::vector<Target> targets;
  std::string known;
  for (const Target& target : kTargets) {
    if (name == "all" || name == target.name) targets.push_back(target);
    known += std::string(target.name) + ", ";
  }
  if (targets.empty()) throw InputError("unknown target \"" + name + "\"; expected one of: " + known + "all");
  return targets;
}

/// Prints the missing sequences of a target, if any.
void print_missing_data(const Target& target, const PlanMatrix& matrix) {
  std::string missing;
  for (const PlanSequence& sequence : matrix.sequences) {
    if (!sequence.unavailable_reason.empty()) missing += "  " + sequence.unavailable_reason + "\n";
  }
  if (missing.empty() && !matrix.runs.empty()) return;
  std::cout << fmt::format("{}: missing data:\n{}It requires {}.\n\n", target.name, missing,
                           target.real_data);
}

/// Executes the runs of a plan that are not in the store. @return false if interrupted
bool execute_runs(const Target& target, const std::string& plan, const ReproduceArguments& arguments) {
  const PlanMatrix matrix = expand_plan(load_plan(plan), build_name(), {});
  print_missing_data(target, matrix);
  StoreWriter writer(arguments.store);
  const PlanReport report =
      run_plan(matrix, writer, {.jobs = arguments.jobs, .retry = false}, plan_progress());
  std::cout << fmt::format("{}: {} of {} runs executed, {} cached, {} skipped\n", target.name,
                           report.executed, matrix.runs.size(), report.cached, report.missing);
  if (report.profile.runs > 0) std::cout << profile_text(report.profile);
  return !report.interrupted;
}

/// Writes the tables of a target and prints the first one.
void write_tables(const Target& target, const std::vector<StoredRun>& runs, const fs::path& out) {
  const std::optional<report::PaperTable> paper = report::paper_table_of(target.synthetic_plan);
  const std::vector<report::ReportTable> tables =
      paper ? std::vector{report::paper_table(*paper, runs)} : report::metric_tables(runs);
  std::vector<OutputFile> files;
  std::string latex;
  for (const report::ReportTable& table : tables) {
    for (OutputFile& file : report::table_files(table)) {
      file.name = paper ? file.name : std::string(target.name) + "_" + file.name;
      files.push_back(std::move(file));
    }
    latex += report::table_latex(table);
  }
  files.push_back({std::string(target.name) + "_document.tex", report::latex_document(latex)});
  write_files(out, files);
  if (!tables.empty()) std::cout << "\n" << report::table_markdown(tables.front()) << "\n";
}

/// Checks the output folder. Targets may share a folder, so that each one has its own files.
void require_safe_tables(const std::vector<Target>& targets, const fs::path& out, const fs::path& store) {
  OutputLayout page{.names = {"index.html"}, .marks = {}};
  for (const Target& target : kTargets) page.marks.push_back({std::string(target.name) + "_document.tex"});
  require_safe_folder(out, page, {store});
  for (const Target& target : targets) {
    const std::string name = target.name;
    const OutputLayout tables{.names = {name + ".tex", name + ".md", name + ".csv", name + ".json"},
                              .marks = {{name + "_document.tex"}}};
    require_safe_folder(out, tables, {store});
  }
}

int reproduce(const ReproduceArguments& arguments) {
  if (arguments.real && arguments.synthetic)
    throw InputError("--real", "cannot be combined with --synthetic");
  const std::vector<Target> targets = select_targets(arguments.target);
  const fs::path out = arguments.out;
  require_safe_tables(targets, out, arguments.store);
  require_writable(out);
  install_interrupt_handlers();
  bool complete = true;
  std::size_t number = 0;
  for (const Target& target : targets) {
    std::cout << fmt::format("{} ({} of {})\n", target.name, ++number, targets.size()) << std::flush;
    const std::string plan = arguments.real ? target.real_plan : target.synthetic_plan;
    if (plan.empty()) {
      std::cout << fmt::format("{} has no plan for recorded data. It requires {}.\n", target.name,
                               target.real_data);
      complete = false;
      continue;
    }
    const bool finished = execute_runs(target, plan, arguments);
    write_tables(target, Store(arguments.store).plan_runs(plan), out);
    if (!finished) return kExitInterrupted;
  }
  if (!fs::exists(arguments.store)) return kExitFindings;
  const Store store(arguments.store);
  if (store.runs().empty()) return kExitFindings;
  write_files(out, {{"index.html", report::report_html(store, report::report_subject(store, ""))}});
  std::cout << fmt::format("written to {} (tables and index.html); store {}\n", out.string(),
                           arguments.store);
  return complete ? kExitOk : kExitFindings;
}

}  // namespace

Command reproduce_command() {
  const auto arguments = std::make_shared<ReproduceArguments>();
  return {
      .name = "reproduce",
      .summary = "Reproduce a table of the paper; can be resumed after an interruption",
      .example = "reproduce table2 --synthetic --jobs 2",
      .options = {{"TARGET", "table1, table2, table3, openloris or all", &arguments->target},
                  {"--synthetic", "Use rendered sequences [default]", &arguments->synthetic},
                  {"--real", "Use recorded sequences that were registered with `stillpoint data add`",
                   &arguments->real},
                  {"--store", "Database of runs [build/bench/reproduce.sqlite]", &arguments->store},
                  {"--out", "Output folder of tables and the HTML report [build/reproduce]", &arguments->out},
                  {"--jobs",
                   "Number of concurrent accuracy runs [number of processors]",
                   &arguments->jobs,
                   {1, 1000}}},
      .action = [arguments] { return reproduce(*arguments); }};
}

}  // namespace stillpoint::bench
