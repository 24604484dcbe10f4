// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "bench/analysis/comparison.h"
#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/plan/paired_plan.h"
#include "bench/plan/plan_runner.h"
#include "bench/record/output_folder.h"
#include "bench/store/maintenance.h"
#include "bench/store/store.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "reports/text/comparison_report.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kExitInconclusive = 3;

struct CompareArguments {
  std::string base;
  std::string head;
  std::string store = "build/bench/store.sqlite";
  std::string plan = "quick";
  int pairs = 10;
  std::string out;
};

/// Tests for the SQLite file header.
bool is_store(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string header(15, '\0');
  return stream.read(header.data(), static_cast<std::streamsize>(header.size())) &&
         header == "SQLite format 3";
}

bool is_program(const std::string& file) {
  return fs::is_regular_file(file) && access(file.c_str(), X_OK) == 0;
}

/// Tests the file name extension of exported stores.
bool is_export(const std::string& file) { return file.ends_with(".json"); }

/// Runs of a build; of the most recent build if `build` is empty.
std::vector<StoredRun> runs_of_build(const Store& store, std::string build, const std::string& location) {
  const std::vector<StoredRun> all = store.runs();
  if (build.empty() && !all.empty()) build = all.back().identity.build;
  std::vector<StoredRun> runs = store.runs({.build = build});
  if (runs.empty())
    throw InputError(location, "the store has no run of this build; see `stillpoint store list`");
  return runs;
}

/// @param location BASE or HEAD: store, exported store, STORE@COMMIT, or commit in the store of --store
std::vector<StoredRun> stored_runs(const std::string& location, const std::string& default_store) {
  if (is_export(location)) return exported_runs(eval::read_text_file(location), location);
  if (is_store(location)) return runs_of_build(Store(location), "", location);
  const std::size_t at = location.rfind('@');
  if (at != std::string::npos) {
    return runs_of_build(Store(location.substr(0, at)), location.substr(at + 1), location);
  }
  return runs_of_build(Store(default_store), location, location);
}

/// Control comparison of base with itself: repetitions 2k against repetitions 2k - 1.
Comparison control_of(const std::vector<StoredRun>& base) {
  std::vector<StoredRun> odd;
  std::vector<StoredRun> even;
  for (const StoredRun& run : base) {
    std::vector<StoredRun>& half = run.identity.repetition % 2 == 1 ? odd : even;
    half.push_back(run);
    half.back().identity.repetition = (run.identity.repetition + 1) / 2;
  }
  return compare_runs(odd, even);
}

Comparison compare_programs(const CompareArguments& arguments) {
  const ProgramPair programs{fs::canonical(arguments.base), fs::canonical(arguments.head)};
  const PlanMatrix matrix = paired_plan(load_plan(arguments.plan), programs, arguments.pairs);
  const PlanHooks hooks{.on_step = [](const std::string& step) { spdlog::debug("{}", step); },
                        .stop_requested = interrupt_requested};
  {
    StoreWriter writer(arguments.store);
    if (run_plan(matrix, writer, {}, hooks).interrupted)
      throw InputError("compare", "interrupted; run the same command again to continue");
  }
  const Store store(arguments.store);
  const std::vector<StoredRun> base = store.runs({.build = programs.base_build()});
  return with_control(compare_runs(base, store.runs({.build = programs.head_build()})), control_of(base));
}

int exit_code(ChangeClass result) {
  if (result == ChangeClass::kWorse) return kExitFindings;
  return result == ChangeClass::kInconclusive ? kExitInconclusive : kExitOk;
}

int compare(const CompareArguments& arguments) {
  if (arguments.pairs < 1) throw InputError("--pairs", "must be at least 1");
  install_interrupt_handlers();
  const bool programs = !is_store(arguments.base) && is_program(arguments.base) && is_program(arguments.head);
  const Comparison comparison = programs ? compare_programs(arguments)
                                         : compare_runs(stored_runs(arguments.base, arguments.store),
                                                        stored_runs(arguments.head, arguments.store));
  const report::ComparisonTitle title{arguments.base, arguments.head};
  const std::string markdown = report::comparison_markdown(title, comparison);
  std::cout << markdown;
  if (!arguments.out.empty()) {
    write_files(arguments.out, {{"compare.md", markdown},
                                {"compare.json", report::comparison_json(title, comparison)},
                                {"compare.xml", report::comparison_junit(title, comparison)}});
  }
  return exit_code(comparison.result());
}

}  // namespace

Command compare_command() {
  const auto arguments = std::make_shared<CompareArguments>();
  return {
      .name = "compare",
      .summary = "Compare two versions; exit code 0 = same or better, 1 = worse, 2 = error, 3 = inconclusive",
      .example = "compare build/base/stillpoint build/release/stillpoint --plan quick --out build/compare",
      .options =
          {{"BASE",
            "A store, an exported store (.json), STORE@COMMIT, a commit in --store, or a program to execute",
            &arguments->base},
           {"HEAD", "As BASE", &arguments->head},
           {"--store", "Database of runs [build/bench/store.sqlite]", &arguments->store},
           {"--plan", "Plan that the programs execute [quick]", &arguments->plan},
           {"--pairs", "Number of base-head pairs, executed in the order base, head, head, base [10]",
            &arguments->pairs},
           {"--out", "Output folder of compare.md, compare.json and compare.xml (JUnit)", &arguments->out}},
      .action = [arguments] { return compare(*arguments); }};
}

}  // namespace stillpoint::bench
