// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/cli/interrupt.h"
#include "bench/compare/comparison.h"
#include "bench/plan/paired_plan.h"
#include "bench/plan/plan_runner.h"
#include "bench/record/output_folder.h"
#include "bench/store/maintenance.h"
#include "bench/store/store.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "reports/comparison_report.h"

namespace stillpoint {
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

/// Whether a file is a store, by its first bytes.
bool is_store(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string start(15, '\0');
  return stream.read(start.data(), static_cast<std::streamsize>(start.size())) && start == "SQLite format 3";
}

bool is_program(const std::string& file) {
  return fs::is_regular_file(file) && access(file.c_str(), X_OK) == 0;
}

/// Whether a file is an exported store, by its name.
bool is_export(const std::string& file) { return file.ends_with(".json"); }

/// Runs of the newest build in a store, unless a build is named.
std::vector<StoredRun> runs_of_build(const Store& store, std::string build, const std::string& place) {
  const std::vector<StoredRun> all = store.runs();
  if (build.empty() && !all.empty()) build = all.back().identity.build;
  std::vector<StoredRun> runs = store.runs({.build = build});
  if (runs.empty())
    throw InputError(place, "the store has no run of this build; see `stillpoint store list`");
  return runs;
}

/// BASE or HEAD: a store, an exported one, STORE@COMMIT, or a commit in the store of --store.
std::vector<StoredRun> stored_runs(const std::string& place, const std::string& default_store) {
  if (is_export(place)) return exported_runs(read_text_file(place), place);
  if (is_store(place)) return runs_of_build(Store(place), "", place);
  const std::size_t at = place.rfind('@');
  if (at != std::string::npos) return runs_of_build(Store(place.substr(0, at)), place.substr(at + 1), place);
  return runs_of_build(Store(default_store), place, place);
}

/// Repetitions 2k against repetitions 2k - 1 of the base's runs.
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
  const PlanHooks hooks{.on_step = [](const std::string& what) { spdlog::debug("{}", what); },
                        .stop_requested = interrupt_requested};
  {
    Journal journal(arguments.store);
    if (run_plan(matrix, journal, {}, hooks).interrupted)
      throw InputError("compare", "interrupted; call it again to go on");
  }
  const Store store(arguments.store);
  const std::vector<StoredRun> base = store.runs({.build = programs.base_build()});
  return with_control(compare_runs(base, store.runs({.build = programs.head_build()})), control_of(base));
}

int exit_code(ChangeVerdict verdict) {
  if (verdict == ChangeVerdict::kWorse) return kExitFindings;
  return verdict == ChangeVerdict::kInconclusive ? kExitInconclusive : kExitOk;
}

int compare(const CompareArguments& arguments) {
  if (arguments.pairs < 1) throw InputError("--pairs", "must be at least 1");
  watch_interrupts();
  const bool programs = !is_store(arguments.base) && is_program(arguments.base) && is_program(arguments.head);
  const Comparison comparison = programs ? compare_programs(arguments)
                                         : compare_runs(stored_runs(arguments.base, arguments.store),
                                                        stored_runs(arguments.head, arguments.store));
  const ComparisonTitle title{arguments.base, arguments.head};
  const std::string markdown = comparison_markdown(title, comparison);
  std::cout << markdown;
  if (!arguments.out.empty()) {
    write_files(arguments.out, {{"compare.md", markdown},
                                {"compare.json", comparison_json(title, comparison)},
                                {"compare.xml", comparison_junit(title, comparison)}});
  }
  return exit_code(comparison.verdict());
}

}  // namespace

Command compare_command() {
  const auto arguments = std::make_shared<CompareArguments>();
  return {
      .name = "compare",
      .summary = "Judge a change: exit 0 same or better, 1 worse, 2 harness error, 3 inconclusive",
      .example = "compare build/base/stillpoint build/release/stillpoint --plan quick --out build/compare",
      .options =
          {{"BASE",
            "A store, an exported one (.json), STORE@COMMIT, a commit in --store, or a program to run now",
            &arguments->base},
           {"HEAD", "Likewise", &arguments->head},
           {"--store", "Store of commits and of programs' runs [build/bench/store.sqlite]",
            &arguments->store},
           {"--plan", "What programs are run on [quick]", &arguments->plan},
           {"--pairs", "How often programs are run as base, head, head, base [10]", &arguments->pairs},
           {"--out", "Folder for compare.md, compare.json and compare.xml (JUnit)", &arguments->out}},
      .action = [arguments] { return compare(*arguments); },
      .subcommands = {}};
}

}  // namespace stillpoint
