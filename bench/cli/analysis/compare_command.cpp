// SPDX-License-Identifier: BSD-3-Clause
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "bench/analysis/comparison.h"
#include "bench/analysis/metric_change.h"
#include "bench/analysis/run_groups.h"
#include "bench/cli/analysis/paired_execution.h"
#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/model/stored_run.h"
#include "bench/plan/plan_matrix.h"
#include "bench/record/output_folder.h"
#include "bench/store/maintenance/store_export.h"
#include "bench/store/store.h"
#include "bench/systems/source_builds.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "reports/text/comparison_report.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

struct CompareArguments {
  std::string base;
  std::string head;
  std::string store = "build/bench/store.sqlite";
  std::string plan;  ///< empty: "quick"
  int pairs = 0;     ///< 0: as many as the plan needs
  std::string builds;
  std::string out;
  bool allow_missing = false;
  bool json = false;
};

/// Tests for the SQLite file header.
bool is_store(const std::string& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;  // a pipe would block
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

/// Runs of a build; of the newest build of each system if `build` is empty. A build with uncommitted changes
/// is another one than its commit: "abc123" is no prefix of "abc123+ff00".
std::vector<StoredRun> runs_of_build(std::vector<StoredRun> runs, const std::string& build,
                                     const std::string& location) {
  const std::map<std::string, std::string> newest = newest_builds(runs);
  const std::string named = build.empty() ? "" : build_named(runs, build, location);
  std::erase_if(runs, [&](const StoredRun& run) {
    return run.identity.build != (build.empty() ? newest.at(run.identity.system) : named);
  });
  if (runs.empty()) throw InputError(location, "has no finished run; see `stillpoint store list`");
  return runs;
}

/// @param location BASE or HEAD: store, exported store, STORE@COMMIT, or commit in the store of --store
std::vector<StoredRun> stored_runs(const std::string& location, const std::string& default_store) {
  if (is_export(location)) {
    std::vector<StoredRun> runs = exported_runs(eval::read_text_file(location), location);
    return runs.empty() ? runs : runs_of_build(std::move(runs), "", location);
  }
  if (is_store(location)) return runs_of_build(Store(location).runs(), "", location);
  const std::size_t at = location.rfind('@');
  if (at != std::string::npos) {
    return runs_of_build(Store(location.substr(0, at)).runs(), location.substr(at + 1), location);
  }
  std::error_code ignored;
  if (fs::exists(location, ignored) || !fs::exists(default_store, ignored)) {
    throw InputError(location, "is neither a store nor an exported store (.json) nor a commit in the store " +
                                   default_store);
  }
  return runs_of_build(Store(default_store).runs(), location, location);
}

int default_pairs(const PlanMatrix& runs) {
  std::vector<RunIdentity> identities;
  for (const PlannedRun& run : runs.runs) {
    if (runs.sequences[run.sequence].unavailable_reason.empty()) identities.push_back(run.identity);
  }
  return static_cast<int>(pairs_for_plan(identities));
}

BenchPlan compared_plan(const CompareArguments& arguments) {
  return load_plan(arguments.plan.empty() ? "quick" : arguments.plan);
}

int pairs_of(const CompareArguments& arguments, const PlanMatrix& runs) {
  return arguments.pairs > 0 ? arguments.pairs : default_pairs(runs);
}

/// Two systems of different names are compared as one.
std::vector<StoredRun> named_as(std::vector<StoredRun> runs, const std::string& system) {
  for (StoredRun& run : runs) {
    run.identity.system = system;
    run.identity.variant = system;
  }
  return runs;
}

Comparison compare_programs(const CompareArguments& arguments) {
  ProgramPair programs{fs::canonical(arguments.base), fs::canonical(arguments.head)};
  programs.perturbed = accept_perturbation(programs);
  PlanMatrix runs = single_runs(compared_plan(arguments));
  const int pairs = pairs_of(arguments, runs);
  const ExecutedPairs executed = execute_pairs(paired_plan(std::move(runs), programs, pairs), arguments.store,
                                               {programs.base_build(), programs.head_build()});
  Comparison comparison = with_control(compare_runs(executed.base, executed.head, CompareSource::kPrograms),
                                       control_changes(executed.base));
  if (!programs.perturbed)
    comparison.notes.push_back(
        fmt::format("a program does not accept {}: repetitions of a deterministic program are one replicate",
                    kPerturbationKey));
  return comparison;
}

/// A description, or that of a commit: FILE@COMMIT.
struct SystemLocation {
  std::string file;
  std::string commit;  ///< empty: the program as it is
};

std::optional<SystemLocation> system_location(const std::string& location) {
  const std::size_t end = location.rfind(".toml");
  if (end == std::string::npos) return std::nullopt;
  const std::size_t at = location.find('@', end);
  const std::string file = location.substr(0, at);
  if (!parse_system_name(file).file.ends_with(".toml")) return std::nullopt;
  return SystemLocation{file, at == std::string::npos ? "" : location.substr(at + 1)};
}

/// A system, and the use of its build, which keeps `keep_latest` of other processes from removing it.
struct LocatedSystem {
  ExternalSystem system;
  std::shared_ptr<const FileLock> use;  ///< null for a program that is not built here
};

/// The system, of a commit with its program built.
/// @throws InputError if there is no such commit, or it cannot be built
LocatedSystem system_at(const SystemLocation& location, const std::string& builds) {
  ExternalSystem system = load_external_system(location.file);
  if (location.commit.empty()) return {std::move(system), nullptr};
  const SourceBuilds source(system, builds, interrupt_requested);
  const SourceCommit commit = source.commit(location.commit);
  spdlog::info("build {} {}", commit.short_hash(), commit.subject);
  if (source.is_busy()) spdlog::info(kWaitForBuild);
  const SourceBuild build = source.build(commit);
  require_uninterrupted();
  if (!build.failure.empty()) throw InputError(location.file + "@" + location.commit, build.failure);
  return {built_system(std::move(system), commit, build), build.use};
}

Comparison compare_systems(const CompareArguments& arguments) {
  const SystemLocation base = *system_location(arguments.base);
  const LocatedSystem base_system = system_at(base, arguments.builds);
  const LocatedSystem head_system = system_at(*system_location(arguments.head), arguments.builds);
  const SystemPair systems{base_system.system, head_system.system};
  PlanMatrix runs = single_system_runs(compared_plan(arguments), base.file);
  const int pairs = pairs_of(arguments, runs);
  const ExecutedPairs executed =
      execute_pairs(paired_systems(std::move(runs), systems, pairs), arguments.store,
                    {system_build(systems.base, true), system_build(systems.head, false)});
  const std::string name = systems.base.variant == systems.head.variant
                               ? systems.base.variant
                               : systems.base.variant + " -> " + systems.head.variant;
  const std::vector<StoredRun> base_runs = named_as(executed.base, name);
  return with_control(compare_runs(base_runs, named_as(executed.head, name), CompareSource::kPrograms),
                      control_changes(base_runs));
}

Comparison compare_stored(const CompareArguments& arguments) {
  if (arguments.pairs > 0 || !arguments.plan.empty()) {
    throw InputError(
        arguments.pairs > 0 ? "--pairs" : "--plan",
        "applies to two programs or systems; of stores, all runs that both contain are compared");
  }
  const std::vector<StoredRun> base = stored_runs(arguments.base, arguments.store);
  const std::vector<StoredRun> head = stored_runs(arguments.head, arguments.store);
  return compare_runs(base, head);
}

/// @throws InputError if only one of them is a program
bool are_programs(const std::string& base, const std::string& head) {
  const auto executable = [](const std::string& file) { return !is_store(file) && is_program(file); };
  if (executable(base) == executable(head)) return executable(base);
  throw InputError(executable(base) ? head : base,
                   fmt::format("is not a program, but {} is; compare two programs or two stores",
                               executable(base) ? base : head));
}

/// @throws InputError if only one of them is a description
bool are_systems(const std::string& base, const std::string& head) {
  const auto is_description = [](const std::string& file) { return system_location(file).has_value(); };
  if (is_description(base) == is_description(head)) return is_description(base);
  throw InputError(
      is_description(base) ? head : base,
      fmt::format("is not the description of a system, but {} is; compare two descriptions (.toml)",
                  is_description(base) ? base : head));
}

Comparison comparison_of(const CompareArguments& arguments) {
  if (are_systems(arguments.base, arguments.head)) return compare_systems(arguments);
  return are_programs(arguments.base, arguments.head) ? compare_programs(arguments)
                                                      : compare_stored(arguments);
}

int exit_code(ChangeClass result) {
  if (result == ChangeClass::kWorse || result == ChangeClass::kMissing) return kExitFindings;
  return result == ChangeClass::kInconclusive ? kExitInconclusive : kExitOk;
}

int compare(const CompareArguments& arguments) {
  if (!arguments.out.empty()) {
    const std::vector<std::string> files = {"compare.md", "compare.json", "compare.xml"};
    require_safe_folder(arguments.out, {.names = files, .marks = {files}}, {arguments.base, arguments.head});
  }
  install_interrupt_handlers();
  Comparison comparison = comparison_of(arguments);
  comparison.missing_allowed = arguments.allow_missing;
  const report::ComparisonTitle title{arguments.base, arguments.head};
  const std::string markdown = report::comparison_markdown(title, comparison);
  std::cout << (arguments.json ? report::comparison_json(title, comparison) : markdown);
  if (!arguments.out.empty()) {
    write_files(arguments.out, {{"compare.md", markdown},
                                {"compare.json", report::comparison_json(title, comparison)},
                                {"compare.xml", report::comparison_junit(title, comparison)}});
  }
  if (comparison.result() == ChangeClass::kError) {
    throw InputError("compare", fmt::format("all {} of runs failed on both sides; the first failure: {}",
                                            counted(comparison.pairs, "pair"), comparison.first_failure));
  }
  return exit_code(comparison.result());
}

}  // namespace

Command compare_command() {
  const auto arguments = std::make_shared<CompareArguments>();
  return {
      .name = "compare",
      .summary =
          "Compare two versions; exit code 0 = same or better, 1 = worse or missing, 2 = error, 3 = "
          "inconclusive",
      .example = "compare build/base/stillpoint build/release/stillpoint --plan quick --out build/compare",
      .options =
          {{"BASE",
            "A store or exported store (.json), of which the newest build of each system is used, "
            "STORE@COMMIT, a commit in "
            "--store, a program to execute, or the description of a system (FILE.toml, or FILE.toml@COMMIT, "
            "which is built)",
            &arguments->base},
           {"HEAD", "As BASE", &arguments->head},
           {"--store", "Database of runs [build/bench/store.sqlite]", &arguments->store},
           {"--plan", "Plan that the programs or systems execute [quick]", &arguments->plan},
           {"--pairs",
            "Number of base-head pairs of each run, executed in the order base, head, head, base [as many as "
            "the "
            "tests of the plan need; 8 for the rendered sequences of quick]",
            &arguments->pairs,
            {1, 1000}},
           {"--builds", kBuildsHelp, &arguments->builds},
           {"--allow-missing",
            "What base has and HEAD lacks (a sequence, variant, metric or module) is listed, but no finding",
            &arguments->allow_missing},
           {"--json", "Print compare.json instead of Markdown", &arguments->json},
           {"--out", "Output folder of compare.md, compare.json and compare.xml (JUnit)", &arguments->out}},
      .action = [arguments] { return compare(*arguments); }};
}

}  // namespace stillpoint::bench
