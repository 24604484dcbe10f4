// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "bench/cli/analysis/store_subcommand.h"
#include "bench/cli/command_line.h"
#include "bench/cli/commands.h"
#include "bench/record/output_folder.h"
#include "bench/store/maintenance.h"
#include "bench/store/store.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

struct StoreArguments {
  std::string store = "build/bench/store.sqlite";
  std::string run;
  std::string file;
  bool numbers = false;
};

int list(const StoreArguments& arguments) {
  const Store store(arguments.store);
  for (const StoredRun& run : store.runs()) {
    const RunIdentity& identity = run.identity;
    const std::optional<double> ate = metric_value(run, "ate_rmse_m");
    std::cout << fmt::format(
        "{}  {}  {:<20} {:<24} seed {} repetition {}{}  {:<9} {}\n", run.key, identity.build.substr(0, 10),
        identity.sequence, identity.variant, identity.seed, identity.repetition,
        identity.axis.empty() ? "" : fmt::format(" {} = {}", identity.axis, identity.axis_value),
        outcome_name(run.outcome), ate ? fmt::format("ATE {:.4f} m", *ate) : run.detail);
  }
  if (store.unfinished() > 0)
    std::cout << fmt::format("{} runs in progress or interrupted\n", store.unfinished());
  for (const StoredPlan& plan : store.plans()) {
    std::cout << fmt::format("plan {}: {} runs\n", plan.name, plan.run_keys.size());
  }
  return kExitOk;
}

/// @param key complete key or a prefix of it
StoredRun find_run(const Store& store, const std::string& key) {
  for (const StoredRun& run : store.runs()) {
    if (run.key.starts_with(key)) return run;
  }
  throw InputError("run \"" + key + "\"",
                   "not found in " + store.file().string() + "; see `stillpoint store list`");
}

int show(const StoreArguments& arguments) {
  const Store store(arguments.store);
  const StoredRun run = find_run(store, arguments.run);
  std::cout << fmt::format("{} {} {}: {} {}\n{} to {}\n", run.key, run.identity.sequence,
                           run.identity.variant, outcome_name(run.outcome), run.detail, run.started,
                           run.ended);
  for (const Metric& metric : run.metrics) {
    std::cout << fmt::format("{:<28} {:.6g} {}  ({})\n", metric.name, metric.value, metric.unit,
                             metric.protocol);
  }
  for (const ModuleCost& cost : run.costs) {
    std::cout << fmt::format("{:<28} {:.3f} ms per {}, median {:.3f}, p95 {:.3f}, max {:.3f}, {} calls\n",
                             cost.module, cost.mean_ms, cost.per, cost.median_ms, cost.p95_ms, cost.max_ms,
                             cost.calls);
  }
  for (const auto& [kind, blob] : run.blobs) std::cout << fmt::format("{:<28} {}\n", kind, blob);
  std::cout << store.manifest(run);
  return kExitOk;
}

/// File name of an attachment; kinds without a specific name are written as text.
std::string file_name(const std::string& kind) {
  if (kind == "trajectory") return "trajectory.tum";
  if (kind == "timings" || kind == "frames" || kind == "counters") return kind + ".csv";
  if (kind == "stacks") return "stacks.folded";
  if (kind.starts_with(kImageKind)) return "image_" + kind.substr(kImageKind.size()) + ".jpg";
  return kind + (kind == "result" ? ".json" : ".txt");
}

int extract(const StoreArguments& arguments) {
  const Store store(arguments.store);
  const StoredRun run = find_run(store, arguments.run);
  std::vector<OutputFile> files = {{"manifest.json", store.manifest(run)}};
  for (const auto& [kind, blob] : run.blobs) files.push_back({file_name(kind), store.attachment(run, kind)});
  write_files(arguments.file, files);
  for (const OutputFile& file : files)
    std::cout << (std::filesystem::path(arguments.file) / file.name).string() << '\n';
  return kExitOk;
}

int verify(const StoreArguments& arguments) {
  const std::vector<std::string> errors = verify_store(arguments.store);
  for (const std::string& error : errors) std::cout << error << '\n';
  std::cout << (errors.empty() ? "no errors found\n" : fmt::format("{} errors\n", errors.size()));
  return errors.empty() ? kExitOk : kExitFindings;
}

int collect(const StoreArguments& arguments) {
  const GarbageReport report = collect_garbage(arguments.store);
  std::cout << fmt::format("removed {} files ({} bytes) and {} manifests\n", report.files, report.bytes,
                           report.manifests);
  return kExitOk;
}

void print_merge(const MergeReport& report) {
  std::cout << fmt::format("{} runs added, {} already present\n", report.added, report.present);
}

int merge(const StoreArguments& arguments) {
  print_merge(merge_stores(arguments.file, arguments.store));
  return kExitOk;
}

int export_to(const StoreArguments& arguments) {
  const std::filesystem::path file = std::filesystem::absolute(arguments.file);
  const ExportExtent extent = arguments.numbers ? ExportExtent::kNumbers : ExportExtent::kEverything;
  write_files(file.parent_path(), {{file.filename().string(), export_store(arguments.store, extent)}});
  return kExitOk;
}

int import_from(const StoreArguments& arguments) {
  print_merge(import_store(eval::read_text_file(arguments.file), arguments.file, arguments.store));
  return kExitOk;
}

}  // namespace

Command store_command() {
  const auto arguments = std::make_shared<StoreArguments>();
  const auto subcommand = [&](const std::string& name, const std::string& summary, const std::string& example,
                              std::vector<Option> options, int (*action)(const StoreArguments&)) {
    return store_subcommand(name, summary, example, std::move(options), arguments, action);
  };
  std::vector<Command> subcommands = {
      subcommand("list", "List all runs, one per line", "list", {}, list),
      subcommand("show", "Print all data of a run", "show 8f18e31477d2f9b7",
                 {{"KEY", "Key of the run or a prefix of it", &arguments->run}}, show),
      subcommand("extract", "Write trajectory, timings, result and manifest of a run as files",
                 "extract 8f18e31477d2f9b7 /tmp/run",
                 {{"KEY", "Key of the run or a prefix of it", &arguments->run},
                  {"DIR", "Output folder", &arguments->file}},
                 extract),
      subcommand("verify", "Check the integrity of the database and its files; exit code 1 on errors",
                 "verify", {}, verify),
      subcommand("gc", "Remove files that are not referenced by any run", "gc", {}, collect),
      subcommand("merge", "Add the runs of another store", "merge other.sqlite --store all.sqlite",
                 {{"FROM", "The other store", &arguments->file}}, merge),
      subcommand("export", "Write the store as one JSON file", "export runs.json",
                 {{"FILE", "Output file", &arguments->file},
                  {"--numbers", "Without trajectories and manifests; sufficient as a baseline for `compare`",
                   &arguments->numbers}},
                 export_to),
      subcommand("import", "Add the runs of an exported JSON file", "import runs.json",
                 {{"FILE", "Input file", &arguments->file}}, import_from)};
  for (Command& command : acceptance_commands()) subcommands.push_back(std::move(command));
  return {.name = "store",
          .summary = "Inspect, verify, merge, export and import stores of runs",
          .example = "store list --store build/bench/store.sqlite",
          .options = {},
          .action = {},
          .subcommands = std::move(subcommands)};
}

}  // namespace stillpoint::bench
