// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint bench` executes a plan, or estimates its duration; `stillpoint plan` lists plans and their
// runs.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <unordered_set>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/plan/plan_estimate.h"
#include "bench/cli/plan/plan_execution.h"
#include "bench/config/toml_source.h"
#include "bench/plan/execution/bench_table.h"
#include "bench/plan/execution/plan_runner.h"
#include "bench/plan/plan_matrix.h"
#include "bench/record/output_folder.h"
#include "bench/store/store.h"
#include "bench/systems/published_table.h"
#include "bench/systems/slam_system.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "reports/tables/data_table.h"
#include "reports/tables/result_tables.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDefaultStore = "build/bench/store.sqlite";
constexpr const char* kProfileFile = "profile.json";

struct BenchArguments {
  std::string plan;
  std::string store = kDefaultStore;
  std::string out;
  int jobs = 0;  ///< 0 = default of the executor
  std::vector<std::string> filters;
  bool dry_run = false;
  bool json = false;
  bool estimate = false;
  int workers = 0;  ///< simulated by --estimate
  bool retry = false;
  bool no_frame_cache = false;
  ExecutionArguments execution;
};

int exit_code(const std::vector<BenchRow>& rows) {
  if (interrupt_requested()) return kExitInterrupted;
  const bool all_ok = std::all_of(rows.begin(), rows.end(), [](const BenchRow& row) {
    return !row.is_available || row.outcome == Outcome::kOk;
  });
  return all_ok ? kExitOk : kExitFindings;
}

/// `kExitFindings`, with a message, if runs of a plan were not executed because workers died.
int incomplete_code(const PlanMatrix& matrix, const PlanReport& report) {
  const std::size_t lacking = matrix.runs.size() - report.executed - report.cached - report.missing;
  if (lacking == 0 || report.interrupted) return kExitOk;
  std::cout << fmt::format("{} missing; the same command executes what is missing\n",
                           counted(static_cast<std::size_t>(lacking), "run"));
  return kExitFindings;
}

/// Empty, or ", from frame 3 on": how the seeds of a recording differ.
std::string later_text(const PlannedRun& run) {
  if (run.later_frames == 0) return "";
  const char* noise = is_external(run.identity) ? "" : ", with noise";
  return fmt::format(", from frame {} on{}", run.later_frames, noise);
}

/// Keys of the runs in a store, which need not exist.
std::unordered_set<std::string> stored_keys(const fs::path& store) {
  std::unordered_set<std::string> keys;
  if (!fs::exists(store)) return keys;
  for (const StoredRun& run : Store(store).run_headers()) keys.insert(run.key);
  return keys;
}

/// "cached", "pending" or "skipped".
std::string run_state(const PlanMatrix& matrix, const PlannedRun& run,
                      const std::unordered_set<std::string>& stored) {
  if (stored.contains(run_key(run.identity))) return "cached";
  return matrix.sequences[run.sequence].unavailable_reason.empty() ? "pending" : "skipped";
}

/// Prints the runs of a plan for programs. Without a store, none is cached.
int print_runs_of(const PlanMatrix& matrix, const fs::path& store) {
  using report::data_value;
  report::DataTable table{
      .kind = "plan_runs",
      .columns = {"key", "system", "variant", "sequence", "build", "mode", "kind", "seed", "repetition",
                  "axis", "axis_value", "later_frames", "state", "unavailable"},
      .rows = {},
      .notes = {}};
  const std::unordered_set<std::string> stored = stored_keys(store);
  for (const PlannedRun& run : matrix.runs) {
    const RunIdentity& id = run.identity;
    table.rows.push_back({run_key(id), id.system, id.variant, id.sequence, id.build, id.mode, id.kind,
                          id.seed, id.repetition, data_value(id.axis),
                          id.axis.empty() ? report::DataValue() : report::DataValue(id.axis_value),
                          static_cast<std::int64_t>(run.later_frames), run_state(matrix, run, stored),
                          data_value(matrix.sequences[run.sequence].unavailable_reason)});
  }
  std::cout << report::data_json(table);
  return kExitOk;
}

/// Prints the state of each run of the plan. Executes nothing and does not create the store.
int dry_run(const PlanMatrix& matrix, const fs::path& store) {
  const std::unordered_set<std::string> stored = stored_keys(store);
  std::size_t missing = 0;
  for (const PlannedRun& run : matrix.runs) {
    const std::string state = run_state(matrix, run, stored);
    missing += state == "cached" ? 0 : 1;
    std::cout << fmt::format("{:<7}  {}\n", state, run_label(matrix.plan, run.identity) + later_text(run));
  }
  std::cout << fmt::format("{} of {} cached\n", matrix.runs.size() - missing,
                           counted(matrix.runs.size(), "run"));
  return kExitOk;
}

/// Tables that compare the runs with the published results named by the plan.
std::string published_tables(const PlanMatrix& matrix, const Store& store) {
  std::string text;
  const std::vector<StoredRun> runs = store.plan_runs(matrix.plan.name);
  for (const std::string& name : matrix.plan.table.published) {
    const std::string table = report::published_comparison(runs, load_published(name));
    if (!table.empty()) text += "\n" + table;
  }
  return text;
}

/// Folder of the table and the profile; empty: they are only printed.
fs::path output_folder(const BenchArguments& arguments, const BenchPlan& plan) {
  if (!arguments.out.empty()) return arguments.out;
  return arguments.store == kDefaultStore ? fs::path("build/bench") / plan.name : fs::path();
}

/// @param out see `output_folder`
void print_rows(const PlanMatrix& matrix, const std::vector<BenchRow>& rows, const std::string& published,
                const fs::path& out) {
  const std::string title =
      matrix.plan.title + (interrupt_requested() ? " (interrupted: not all runs were executed)" : "");
  const std::string table = markdown_table(rows) + published;
  std::cout << title << "\n\n" << table << '\n';
  if (out.empty()) return;
  write_files(out, {{"table.md", "# " + title + "\n\n" + table}, {"table.json", json_table(title, rows)}});
  std::cout << "written to " << (out / "table.md").string() << " and table.json\n";
}

/// @throws InputError if there is nothing to execute, as the table would be empty
void require_available_run(const PlanMatrix& matrix) {
  const auto is_available = [&](const PlannedRun& run) {
    return matrix.sequences[run.sequence].unavailable_reason.empty();
  };
  if (std::ranges::any_of(matrix.runs, is_available)) return;
  throw InputError(
      matrix.plan.path,
      "none of its sequences is available: " +
          (matrix.sequences.empty() ? "no sequence matches" : matrix.sequences.front().unavailable_reason));
}

/// @throws InputError as `load_plan`, and if workers would not know an option, as they only get the plan
BenchPlan plan_of(const BenchArguments& arguments) {
  if (arguments.no_frame_cache && arguments.execution.executor != "local")
    throw InputError("--no-frame-cache", "requires --executor local; set frame_cache = false in the plan");
  BenchPlan plan = load_plan(arguments.plan);
  plan.frame_cache = plan.frame_cache && !arguments.no_frame_cache;
  return plan;
}

int run_bench(const BenchArguments& arguments) {
  install_interrupt_handlers();
  const PlanMatrix matrix = expand_plan(plan_of(arguments), build_name(), arguments.filters);
  if (matrix.runs.empty() && !arguments.filters.empty())
    throw InputError("--filter", "matches no run of the plan; see `stillpoint plan show`");
  const auto last = std::ranges::max_element(matrix.runs, {}, &PlannedRun::later_frames);
  if (last != matrix.runs.end() && last->later_frames > 0)
    spdlog::info(
        "seeds of recorded sequences begin later, by 0 to {} frames, those of this odometry with noise of a "
        "gray level: they are replicates",
        last->later_frames);
  if (arguments.workers > 0 && !arguments.estimate) throw InputError("--workers", "requires --estimate");
  if (arguments.json && !arguments.dry_run && !arguments.estimate)
    throw InputError("--json",
                     "requires --dry-run or --estimate; a plan that is executed writes table.json to --out");
  if (arguments.dry_run)
    return arguments.json ? print_runs_of(matrix, arguments.store) : dry_run(matrix, arguments.store);
  if (arguments.estimate) {
    const PlanEstimate estimate = estimate_plan(matrix, arguments.store,
                                                {.jobs = local_jobs(arguments.jobs),
                                                 .tasks = arguments.execution.tasks,
                                                 .simulated = arguments.workers});
    std::cout << (arguments.json ? estimate_json(estimate) : estimate_text(estimate));
    return kExitOk;
  }
  require_available_run(matrix);
  const fs::path out = output_folder(arguments, matrix.plan);
  if (!out.empty()) {
    require_safe_folder(
        out, {.names = {"table.md", "table.json", kProfileFile}, .marks = {{"table.md", "table.json"}}},
        {arguments.store});
    require_writable(out);
  }
  const auto start = std::chrono::steady_clock::now();
  const PlanReport report = execute_plan(
      matrix, arguments.store, {.jobs = arguments.jobs, .retry = arguments.retry}, arguments.execution);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  const Store store(arguments.store);
  const std::vector<BenchRow> rows = plan_rows(matrix, store);
  print_rows(matrix, rows, published_tables(matrix, store), out);
  std::cout << fmt::format("{} of {} executed, {} cached; store {}\n", report.executed,
                           counted(matrix.runs.size(), "run"), report.cached, arguments.store);
  if (report.executed > 0) std::cout << rate_text(report.executed, elapsed.count()) << '\n';
  if (report.profile.runs > 0) {
    if (!out.empty()) write_files(out, {{kProfileFile, profile_json(report.profile)}});
    std::cout << profile_text(report.profile);
  }
  return std::max(exit_code(rows), incomplete_code(matrix, report));
}

}  // namespace

Command bench_command() {
  const auto arguments = std::make_shared<BenchArguments>();
  Command command = {
      .name = "bench",
      .summary = "Execute the runs of a plan that are not in the store; print a table of scores and times",
      .example = "bench quick --store /tmp/store.sqlite --jobs 2",
      .options = {{"PLAN", "Plan: an embedded name (quick) or a TOML file", &arguments->plan},
                  {"--store", fmt::format("Database of runs [{}]", kDefaultStore), &arguments->store},
                  {"--out",
                   "Output folder of table.md, table.json and profile.json [none with --store, else "
                   "build/bench/PLAN]",
                   &arguments->out},
                  {"--jobs",
                   "Number of concurrent accuracy runs [processors; 1 per task of slurm and ssh]",
                   &arguments->jobs,
                   {1, 1000}},
                  {"--filter",
                   "Execute only runs whose sequence, variant or system matches this glob; may be repeated",
                   &arguments->filters},
                  {"--dry-run", "List the runs and their state; execute none", &arguments->dry_run},
                  {"--json", "With --dry-run or --estimate: print JSON; see bench/README.md, \"Schemas\"",
                   &arguments->json},
                  {"--estimate", "Print how long the plan takes, with --tasks also by tasks; execute nothing",
                   &arguments->estimate},
                  {"--workers",
                   "With --estimate: simulate the plan and its multiples on this many workers",
                   &arguments->workers,
                   {1, 10000}},
                  {"--no-frame-cache",
                   "Every run decodes all images, as with frame_cache = false in the plan",
                   &arguments->no_frame_cache},
                  {"--retry", "Execute failed runs again", &arguments->retry}},
      .action = [arguments] { return run_bench(*arguments); }};
  for (Option& option : execution_options(arguments->execution)) command.options.push_back(std::move(option));
  return command;
}

namespace {

int list(bool json) {
  if (json) {
    report::DataTable table{.kind = "plan_list", .columns = {"name", "title"}, .rows = {}, .notes = {}};
    for (const std::string& name : embedded_names(TomlKind::kPlan))
      table.rows.push_back({name, load_plan(name).title});
    std::cout << report::data_json(table);
    return kExitOk;
  }
  for (const std::string& name : embedded_names(TomlKind::kPlan)) {
    std::cout << fmt::format("{:<32} {}\n", name, load_plan(name).title);
  }
  return kExitOk;
}

int show(const std::string& name, bool json) {
  const PlanMatrix matrix = expand_plan(load_plan(name), build_name(), {});
  if (json) return print_runs_of(matrix, "");
  std::cout << matrix.plan.title << "\n\n";
  for (const PlannedRun& run : matrix.runs) {
    const std::string& missing = matrix.sequences[run.sequence].unavailable_reason;
    std::cout << run_key(run.identity) << "  " << run_label(matrix.plan, run.identity)
              << (missing.empty() ? "" : "  (not available)") << '\n';
  }
  std::cout << fmt::format("{} of {}\n", counted(matrix.runs.size(), "run"),
                           counted(matrix.sequences.size(), "sequence"));
  return kExitOk;
}

}  // namespace

Command plan_command() {
  const auto name = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  const Option json_option{"--json", report::kJsonHelp, json.get()};
  return {.name = "plan",
          .summary = "List plans and their runs",
          .example = "plan show quick",
          .subcommands = {
              {.name = "show",
               .summary = "List all runs of a plan with their keys",
               .example = "plan show quick",
               .options = {{"PLAN", "Plan: an embedded name or a TOML file", name.get()}, json_option},
               .action = [name, json] { return show(*name, *json); }},
              {.name = "list",
               .summary = "List the embedded plans",
               .example = "plan list",
               .options = {json_option},
               .action = [json] { return list(*json); }}}};
}

}  // namespace stillpoint::bench
