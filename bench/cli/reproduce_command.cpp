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
#include "bench/cli/plan_hooks.h"
#include "bench/record/output_folder.h"
#include "bench/systems/own_odometry.h"
#include "core/base/error.h"
#include "reports/page/report_page.h"
#include "reports/tables/paper_tables.h"
#include "reports/tables/result_tables.h"
#include "reports/tables/table_formats.h"

namespace stillpoint {
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

/// A table or figure of the paper, and the plans that make its numbers.
struct Target {
  const char* name;
  const char* synthetic_plan;
  const char* real_plan;  ///< empty: there is none
  const char* real_data;  ///< what it needs, and how it is got
};
constexpr const char* kTumData =
    "the fr3_walking sequences of the TUM RGB-D dataset; unpack them and name them with `stillpoint data add "
    "walking_xyz DIR` and so on";
constexpr const char* kOpenlorisData =
    "the OpenLORIS-Scene recordings, which are given out on request; run `stillpoint run` over each, and "
    "`stillpoint "
    "eval openloris` over the results";
constexpr Target kTargets[] = {{"table1", "table1_tum_synthetic", "table1_tum", kTumData},
                               {"table2", "table2_ablation_synthetic", "table2_ablation", kTumData},
                               {"table3", "table3_runtime", "", kOpenlorisData},
                               {"openloris", "openloris_synthetic", "", kOpenlorisData}};

std::vector<Target> chosen(const std::string& name) {
  std::vector<Target> targets;
  std::string known;
  for (const Target& target : kTargets) {
    if (name == "all" || name == target.name) targets.push_back(target);
    known += std::string(target.name) + ", ";
  }
  if (targets.empty())
    throw InputError("\"" + name + "\"", "is nothing of the paper; there are: " + known + "all");
  return targets;
}

/// Says once for each target what is not at hand.
void tell_missing(const Target& target, const PlanMatrix& matrix) {
  std::string missing;
  for (const PlanSequence& sequence : matrix.sequences) {
    if (!sequence.missing.empty()) missing += "  " + sequence.missing + "\n";
  }
  if (missing.empty() && !matrix.runs.empty()) return;
  std::cout << fmt::format("{} lacks data:\n{}It needs {}.\n\n", target.name, missing, target.real_data);
}

/// Makes what is missing of a target's runs. @return false if it was interrupted
bool make_runs(const Target& target, const std::string& plan, const ReproduceArguments& arguments) {
  const PlanMatrix matrix = expand_plan(load_plan(plan), build_name(), {});
  tell_missing(target, matrix);
  Journal journal(arguments.store);
  const PlanReport report = run_plan(matrix, journal, {.jobs = arguments.jobs, .retry = false}, plan_hooks());
  std::cout << fmt::format("{}: {} runs made, {} were there, {} lack their sequence\n", target.name,
                           report.made, report.kept, report.missing);
  return !report.interrupted;
}

/// Writes the tables of a target and shows the first.
void write_tables(const Target& target, const std::vector<StoredRun>& runs, const fs::path& out) {
  const std::optional<PaperTable> paper = paper_table_of(target.synthetic_plan);
  const std::vector<ReportTable> tables =
      paper ? std::vector{paper_table(*paper, runs)} : metric_tables(runs);
  std::vector<OutputFile> files;
  std::string latex;
  for (const ReportTable& table : tables) {
    for (OutputFile& file : table_files(table)) {
      file.name = paper ? file.name : std::string(target.name) + "_" + file.name;
      files.push_back(std::move(file));
    }
    latex += table_latex(table);
  }
  files.push_back({std::string(target.name) + "_document.tex", latex_document(latex)});
  write_files(out, files);
  if (!tables.empty()) std::cout << "\n" << table_markdown(tables.front()) << "\n";
}

int reproduce(const ReproduceArguments& arguments) {
  if (arguments.real && arguments.synthetic)
    throw InputError("--real", "excludes --synthetic; give one of them");
  if (arguments.jobs < 1) throw InputError("--jobs", "must be at least 1");
  const std::vector<Target> targets = chosen(arguments.target);
  const fs::path out = arguments.out;
  require_writable(out);
  watch_interrupts();
  bool whole = true;
  std::size_t number = 0;
  for (const Target& target : targets) {
    std::cout << fmt::format("{} ({} of {})\n", target.name, ++number, targets.size()) << std::flush;
    const std::string plan = arguments.real ? target.real_plan : target.synthetic_plan;
    if (plan.empty()) {
      std::cout << fmt::format("{} has no plan over real data. It needs {}.\n", target.name,
                               target.real_data);
      whole = false;
      continue;
    }
    const bool finished = make_runs(target, plan, arguments);
    write_tables(target, Store(arguments.store).plan_runs(plan), out);
    if (!finished) return kExitInterrupted;
  }
  if (!fs::exists(arguments.store)) return kExitFindings;
  const Store store(arguments.store);
  if (store.runs().empty()) return kExitFindings;
  write_files(out, {{"index.html", report_html(store, report_subject(store, ""))}});
  std::cout << fmt::format("written to {} (tables and index.html); store {}\n", out.string(),
                           arguments.store);
  return whole ? kExitOk : kExitFindings;
}

}  // namespace

Command reproduce_command() {
  const auto arguments = std::make_shared<ReproduceArguments>();
  return {
      .name = "reproduce",
      .summary = "From data to a finished table of the paper; call it again after any interruption",
      .example = "reproduce table2 --synthetic --jobs 2",
      .options = {{"TARGET", "table1, table2, table3, openloris or all", &arguments->target},
                  {"--synthetic", "On sequences that the program renders [the default]",
                   &arguments->synthetic},
                  {"--real", "On recordings, as far as they are named with `stillpoint data add`",
                   &arguments->real},
                  {"--store", "File that keeps the runs [build/bench/reproduce.sqlite]", &arguments->store},
                  {"--out", "Folder for tables and the page [build/reproduce]", &arguments->out},
                  {"--jobs", "Accuracy runs at a time [one for each processor]", &arguments->jobs}},
      .action = [arguments] { return reproduce(*arguments); },
      .subcommands = {}};
}

}  // namespace stillpoint
