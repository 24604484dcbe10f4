// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint store`: inspects, checks and merges stores of runs, and accepts changes of their metrics.
#include <algorithm>
#include <iostream>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "bench/analysis/commit_history.h"
#include "bench/cli/analysis/import/evo_import.h"
#include "bench/cli/analysis/import/result_folders.h"
#include "bench/cli/command_line.h"
#include "bench/config/spelling.h"
#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"
#include "bench/record/output_folder.h"
#include "bench/store/find_run.h"
#include "bench/store/maintenance/maintenance.h"
#include "bench/store/maintenance/salvage.h"
#include "bench/store/maintenance/store_export.h"
#include "bench/store/store.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"
#include "reports/frames/stored_recording.h"
#include "reports/tables/data_table.h"
#include "reports/tables/tidy_runs.h"

namespace stillpoint::bench {
namespace {

/// Adds the store and the action to a command. With other arguments, the store is an option only.
/// @param arguments target of the options; must have a member `store`
template <class Arguments>
Command store_subcommand(Command command, const std::shared_ptr<Arguments>& arguments,
                         int (*action)(const Arguments&)) {
  const bool has_arguments = std::ranges::any_of(
      command.options, [](const Option& option) { return !option.name.starts_with('-'); });
  command.options.push_back(store_option(&arguments->store));
  if (has_arguments) command.options.back().argument.clear();
  command.action = [arguments, action] { return action(*arguments); };
  return command;
}

struct AcceptArguments {
  std::string store = "build/bench/store.sqlite";
  std::string system;
  bool json = false;
  Acceptance subject;
};

/// @throws InputError if `name` does not occur in the history, as the acceptance would then have no effect
template <class NameOf>
void require_known(const CommitHistory& history, const std::string& option, const std::string& name,
                   NameOf name_of) {
  std::set<std::string> known;
  for (const HistorySeries& series : history.series) known.insert(name_of(series));
  if (known.contains(name)) return;
  const std::vector<std::string> names(known.begin(), known.end());
  throw InputError(option, "\"" + name + "\" does not occur in the store" + suggestion(name, names));
}

/// Checks all names of the acceptance and expands its abbreviated commit.
Acceptance resolved(const AcceptArguments& arguments) {
  Acceptance subject = arguments.subject;
  if (subject.metric.empty()) throw InputError("--metric", "is required: the name of the metric or module");
  const CommitHistory history = commit_history(Store(arguments.store), arguments.system);
  subject.commit = history.commits[find_commit(history, subject.commit)].name;
  require_known(history, "--metric", subject.metric,
                [](const HistorySeries& series) { return series.metric; });
  if (!subject.variant.empty()) {
    require_known(history, "--variant", subject.variant,
                  [](const HistorySeries& series) { return series.subject.variant; });
  }
  if (!subject.sequence.empty()) {
    require_known(history, "--sequence", subject.sequence,
                  [](const HistorySeries& series) { return series.subject.sequence; });
  }
  return subject;
}

std::string describe(const Acceptance& subject) {
  return fmt::format("{} of {} on {} at {}", subject.metric,
                     subject.variant.empty() ? "all variants" : subject.variant,
                     subject.sequence.empty() ? "all sequences" : subject.sequence, subject.commit);
}

int accept(const AcceptArguments& arguments) {
  if (arguments.subject.reason.empty())
    throw InputError("--reason", "is required: why the change is accepted");
  Acceptance subject = resolved(arguments);
  subject.accepted = utc_now();
  write_acceptances(arguments.store, {subject});
  std::cout << "accepted: " << describe(subject) << '\n';
  return kExitOk;
}

int withdraw(const AcceptArguments& arguments) {
  const Acceptance subject = resolved(arguments);
  if (!withdraw_acceptance(arguments.store, subject))
    throw InputError("store withdraw",
                     describe(subject) + " was not accepted; see `stillpoint store accepted`");
  std::cout << "no longer accepted: " << describe(subject) << '\n';
  return kExitOk;
}

int print_acceptances(const std::vector<Acceptance>& acceptances) {
  using report::data_value;
  report::DataTable table{.kind = "store_accepted",
                          .columns = {"accepted", "commit", "metric", "variant", "sequence", "reason"},
                          .rows = {},
                          .notes = {}};
  for (const Acceptance& acceptance : acceptances)
    table.rows.push_back({acceptance.accepted, acceptance.commit, acceptance.metric,
                          data_value(acceptance.variant), data_value(acceptance.sequence),
                          acceptance.reason});
  std::cout << report::data_json(table);
  return kExitOk;
}

int list(const AcceptArguments& arguments) {
  const std::vector<Acceptance> acceptances = Store(arguments.store).acceptances();
  if (arguments.json) return print_acceptances(acceptances);
  for (const Acceptance& acceptance : acceptances)
    std::cout << acceptance.accepted << "  " << describe(acceptance) << ": " << acceptance.reason << '\n';
  return kExitOk;
}

/// `accept`, `withdraw` and `accepted`.
std::vector<Command> acceptance_commands() {
  const auto arguments = std::make_shared<AcceptArguments>();
  Acceptance& subject = arguments->subject;
  const std::vector<Option> subject_options = {
      {"COMMIT", "Last commit of the range in which the metric changed; may be abbreviated", &subject.commit},
      {"--metric", "Name of the metric or module as printed by `stillpoint regressions`", &subject.metric},
      {"--variant", "Only this variant [all]", &subject.variant},
      {"--sequence", "Only this sequence [all]", &subject.sequence},
      {"--system", "System whose commits or versions are meant [stillpoint]", &arguments->system}};
  std::vector<Option> with_reason = subject_options;
  with_reason.push_back({"--reason", "Why the change is accepted", &subject.reason});
  return {store_subcommand(
              {.name = "accept",
               .summary = "Mark a metric change as accepted, so that it is no open regression",
               .example = "store accept 11826db --metric state_optimization --reason \"exact solver\"",
               .options = with_reason},
              arguments, accept),
          store_subcommand({.name = "withdraw",
                            .summary = "Withdraw an acceptance",
                            .example = "store withdraw 11826db --metric state_optimization",
                            .options = subject_options},
                           arguments, withdraw),
          store_subcommand({.name = "accepted",
                            .summary = "List all accepted changes, one per line",
                            .example = "store accepted build/bench/store.sqlite",
                            .options = {{"--json", report::kJsonHelp, &arguments->json}}},
                           arguments, list)};
}

struct StoreArguments {
  std::string store = "build/bench/store.sqlite";
  std::string run;
  std::string file;
  std::vector<std::string> equal;
  EvoNames names;
  std::string results, truth;
  bool mcap = false;
  bool numbers = false;
  bool tidy = false;
  bool fit_scale = false;
  bool force = false;
  bool json = false;
};

int print_runs(const std::vector<StoredRun>& runs) {
  using report::data_value;
  const std::string_view headline = headline_metric().id;
  report::DataTable table{
      .kind = "store_list",
      .columns = {"key", "system", "variant", "sequence", "build", "mode", "kind", "seed", "repetition",
                  "axis", "axis_value", "outcome", "detail", "started", "ended", std::string(headline)},
      .rows = {},
      .notes = {}};
  for (const StoredRun& run : runs) {
    const RunIdentity& id = run.identity;
    table.rows.push_back({run.key, id.system, id.variant, id.sequence, id.build, id.mode, id.kind, id.seed,
                          id.repetition, data_value(id.axis),
                          id.axis.empty() ? report::DataValue() : report::DataValue(id.axis_value),
                          outcome_name(run.outcome), data_value(run.detail), run.started, run.ended,
                          data_value(metric_value(run, headline))});
  }
  std::cout << report::data_json(table);
  return kExitOk;
}

int list(const StoreArguments& arguments) {
  const Store store(arguments.store);
  if (arguments.json) return print_runs(store.runs());
  for (const StoredRun& run : store.runs()) {
    const RunIdentity& identity = run.identity;
    const std::optional<double> headline = metric_value(run, headline_metric().id);
    std::cout << fmt::format(
        "{}  {:<10}  {:<20} {:<24} seed {} repetition {}{}  {:<9} {}\n", run.key,
        identity.build.substr(0, 10), identity.sequence, identity.variant, identity.seed, identity.repetition,
        identity.axis.empty() ? "" : fmt::format(" {} = {}", identity.axis, identity.axis_value),
        outcome_name(run.outcome), headline ? value_text(headline_metric(), *headline) : run.detail);
  }
  if (store.unfinished() > 0)
    std::cout << fmt::format("{} in progress or interrupted\n",
                             counted(static_cast<std::size_t>(store.unfinished()), "run"));
  for (const StoredPlan& plan : store.plans()) {
    std::cout << fmt::format("plan {}: {}\n", plan.name, counted(plan.run_keys.size(), "run"));
  }
  return kExitOk;
}

int show(const StoreArguments& arguments) {
  const Store store(arguments.store);
  const StoredRun run = find_run(store, arguments.run);
  if (arguments.json) {
    std::cout << report::data_json(report::tidy_table(std::span(&run, 1)));
    return kExitOk;
  }
  const auto after = [](std::string_view separator, const std::string& text, std::string_view end = "") {
    return text.empty() ? "" : fmt::format("{}{}{}", separator, text, end);
  };
  std::cout << fmt::format("{} {} {}: {}{}\n{} to {}\n", run.key, run.identity.sequence, run.identity.variant,
                           outcome_name(run.outcome), after(" ", run.detail), run.started, run.ended);
  for (const Metric& metric : run.metrics) {
    std::cout << fmt::format("{:<28} {:.6g}{}{}\n", metric.name, metric.value, after(" ", metric.unit),
                             after("  (", metric.protocol, ")"));
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
  if (kind == "timings" || kind == "frames" || kind == "counters" || kind == "landmarks")
    return kind + ".csv";
  if (kind == "claims") return "status.csv";
  if (kind == "stacks") return "stacks.folded";
  if (kind == "surfaces") return "surfaces.ply";
  if (kind.starts_with(kImageKind)) return "image_" + kind.substr(kImageKind.size()) + ".jpg";
  return kind + (kind == "result" ? ".json" : ".txt");
}

int extract(const StoreArguments& arguments) {
  const Store store(arguments.store);
  const StoredRun run = find_run(store, arguments.run);
  std::vector<OutputFile> files = {{"manifest.json", store.manifest(run)}};
  for (const auto& [kind, blob] : run.blobs) files.push_back({file_name(kind), store.attachment(run, kind)});
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const OutputFile& file : files) names.push_back(file.name);
  const std::filesystem::path folder = arguments.file;
  const std::filesystem::path recording = folder / "run.mcap";
  if (arguments.mcap && std::filesystem::exists(recording))
    throw InputError(recording.string(), "exists; choose another folder or remove it");
  require_safe_folder(folder, {.names = names, .marks = {names}}, {});
  write_files(folder, files);
  for (const OutputFile& file : files) std::cout << (folder / file.name).string() << '\n';
  if (!arguments.mcap) return kExitOk;
  const report::StoredRecording written = report::write_stored_recording(recording, store, run);
  std::cout << fmt::format("{}\n  not in the store: {}; `stillpoint run --mcap` records them\n",
                           recording.string(), fmt::join(written.missing, ", "));
  return kExitOk;
}

/// What `verify` found.
struct Findings {
  std::string kind;    ///< of the table for programs
  std::string column;  ///< its only one
  std::string none;    ///< without findings
  std::vector<std::string> sentences;
};

int print(const Findings& findings, bool json) {
  if (json) {
    report::DataTable table{.kind = findings.kind, .columns = {findings.column}, .rows = {}, .notes = {}};
    for (const std::string& sentence : findings.sentences) table.rows.push_back({sentence});
    std::cout << report::data_json(table);
  } else {
    for (const std::string& sentence : findings.sentences) std::cout << sentence << '\n';
    std::cout << (findings.sentences.empty() ? findings.none + "\n"
                                             : counted(findings.sentences.size(), findings.column) + "\n");
  }
  return findings.sentences.empty() ? kExitOk : kExitFindings;
}

int verify(const StoreArguments& arguments) {
  const std::vector<std::string>& pair = arguments.equal;
  if (!pair.empty())
    return print({"store_differences", "difference", "equal", store_differences(pair.front(), pair.back())},
                 arguments.json);
  return print({"store_verify", "error", "no errors found", verify_store(arguments.store)}, arguments.json);
}

int collect(const StoreArguments& arguments) {
  const GarbageReport report = collect_garbage(arguments.store);
  std::cout << fmt::format("removed {} ({} bytes) and {}\n",
                           counted(static_cast<std::size_t>(report.files), "file"), report.bytes,
                           counted(static_cast<std::size_t>(report.manifests), "manifest"));
  return kExitOk;
}

/// @return findings if runs contradict those of the store
int print_merge(const MergeReport& report) {
  std::cout << fmt::format(
      "{} added, {} already present{}\n", counted(report.added, "run"), report.present,
      report.restored > 0 ? fmt::format(", {} of these restored", counted(report.restored, "file")) : "");
  if (report.contradicting.empty()) return kExitOk;
  std::cout << fmt::format(
      "{} of these ended with other results there, which are kept; put the others into "
      "a store of their own:\n  {}\n",
      report.contradicting.size(), fmt::join(report.contradicting, "\n  "));
  return kExitFindings;
}

int merge(const StoreArguments& arguments) {
  return print_merge(merge_stores(arguments.file, arguments.store));
}

int export_tidy(const StoreArguments& arguments) {
  if (arguments.numbers) throw InputError("--numbers", "has no effect with --tidy, which has no files");
  const OutputRules rules{
      .inputs = {arguments.store}, .force = arguments.force, .beginning = report::tidy_header()};
  require_safe_output(arguments.file, rules);
  write_output(arguments.file, report::tidy_text(Store(arguments.store).runs()), rules);
  return kExitOk;
}

int export_to(const StoreArguments& arguments) {
  if (arguments.tidy) return export_tidy(arguments);
  const OutputRules rules{
      .inputs = {arguments.store}, .force = arguments.force, .beginning = exported_beginning()};
  require_safe_output(arguments.file, rules);
  const ExportExtent extent = arguments.numbers ? ExportExtent::kNumbers : ExportExtent::kEverything;
  write_output(arguments.file, export_store(arguments.store, extent), rules);
  return kExitOk;
}

/// @throws InputError if one of the options is set, each a name and its value
void require_unset(const std::vector<std::pair<std::string, std::string>>& options, const std::string& file) {
  for (const auto& [name, value] : options) {
    if (!value.empty()) throw InputError(name, "has no effect on " + file + "; omit it");
  }
}

int import_from(const StoreArguments& arguments) {
  const EvoNames& names = arguments.names;
  if (is_result_source(arguments.file)) {
    require_unset({{"--sequence", names.sequence}}, arguments.file);
    return print_merge(import_results({.path = arguments.file,
                                       .results = arguments.results,
                                       .truth = arguments.truth,
                                       .system = names.system,
                                       .fit_scale = arguments.fit_scale},
                                      arguments.store));
  }
  require_unset({{"--results", arguments.results},
                 {"--truth", arguments.truth},
                 {"--fit-scale", arguments.fit_scale ? "set" : ""}},
                arguments.file);
  if (is_zip_file(arguments.file)) {
    return print_merge(import_evo(arguments.file, arguments.store, names));
  }
  require_unset({{"--system", names.system}, {"--sequence", names.sequence}}, arguments.file);
  return print_merge(import_store(eval::read_text_file(arguments.file), arguments.file, arguments.store));
}

int salvage(const StoreArguments& arguments) {
  const SalvageReport report = salvage_store(arguments.store, arguments.file);
  for (const auto& [table, rows] : report.saved) std::cout << fmt::format("saved {:<12} {}\n", table, rows);
  for (const std::string& loss : report.losses) std::cout << "lost: " << loss << '\n';
  std::cout << (report.losses.empty() ? "nothing is lost\n"
                                      : fmt::format("{} {}\n", report.losses.size(),
                                                    report.losses.size() == 1 ? "loss" : "losses"));
  return report.losses.empty() ? kExitOk : kExitFindings;
}

/// Subcommands that inspect single runs.
std::vector<Command> run_subcommands(const std::shared_ptr<StoreArguments>& arguments) {
  const Option key{"KEY", "Key of the run or a prefix of it", &arguments->run};
  const Option json{"--json", report::kJsonHelp, &arguments->json};
  return {
      store_subcommand({.name = "list",
                        .summary = "List all runs, one per line",
                        .example = "store list build/bench/store.sqlite",
                        .options = {json}},
                       arguments, list),
      store_subcommand({.name = "show",
                        .summary = "Print all data of a run",
                        .example = "store show 8f18e31477d2f9b7",
                        .options = {key, json}},
                       arguments, show),
      store_subcommand({.name = "extract",
                        .summary = "Write trajectory, timings, result and manifest of a run as files",
                        .example = "store extract 8f18e31477d2f9b7 /tmp/run --mcap",
                        .options = {key,
                                    {"DIR", "Output folder", &arguments->file},
                                    {"--mcap",
                                     "Also write run.mcap, a recording for Foxglove and rerun, of what the "
                                     "store has",
                                     &arguments->mcap}}},
                       arguments, extract)};
}

Command salvage_command(const std::shared_ptr<StoreArguments>& arguments) {
  return {
      .name = "salvage",
      .summary = "Copy what is readable of a damaged store into a new one; exit code 1 if something is lost",
      .example = "store salvage damaged.sqlite new.sqlite",
      .options = {{"STORE", "The damaged store; it is not changed", &arguments->store},
                  {"OUT", "The new store; must not exist", &arguments->file}},
      .action = [arguments] { return salvage(*arguments); }};
}

/// Subcommands that check, clean, merge and transfer whole stores.
std::vector<Command> maintenance_subcommands(const std::shared_ptr<StoreArguments>& arguments) {
  const Option without_blobs{"--numbers",
                             "Without trajectories and manifests; sufficient as a baseline for `compare`",
                             &arguments->numbers};
  const Option equal{
      .name = "--equal",
      .help = "Instead compare two stores by content, without times and hosts; exit code 1 if they differ",
      .target = &arguments->equal,
      .values = 2};
  return {
      store_subcommand({.name = "verify",
                        .summary = "Check the integrity of the database and its files; exit code 1 on errors",
                        .example = "store verify build/bench/store.sqlite",
                        .options = {equal, {"--json", report::kJsonHelp, &arguments->json}}},
                       arguments, verify),
      store_subcommand({.name = "gc",
                        .summary = "Remove files that are not referenced by any run",
                        .example = "store gc build/bench/store.sqlite"},
                       arguments, collect),
      store_subcommand({.name = "merge",
                        .summary = "Add the runs of another store",
                        .example = "store merge other.sqlite --store all.sqlite",
                        .options = {{"FROM", "The other store", &arguments->file}}},
                       arguments, merge),
      store_subcommand({.name = "export",
                        .summary = "Write the store as one JSON file, or its metrics as a CSV table",
                        .example = "store export runs.csv --tidy",
                        .options = {{"FILE", "Output file", &arguments->file},
                                    without_blobs,
                                    {"--tidy", "CSV with a row for each run and metric", &arguments->tidy},
                                    {"--force", "Replace an existing export", &arguments->force}}},
                       arguments, export_to),
      store_subcommand(
          {.name = "import",
           .summary = "Add the runs of an exported JSON file, a result of evo (.zip), a result folder of "
                      "ov_eval, evalio or VSLAM-LAB, or an experiment file of VSLAM-LAB",
           .example = "store import runs.json",
           .options = {{"FILE", "Input file or folder", &arguments->file},
                       {"--system",
                        "Name of evo's estimate, or of the system of a folder of VSLAM-LAB "
                        "[of its path]",
                        &arguments->names.system},
                       {"--sequence", "Name of evo's reference [of its path]", &arguments->names.sequence},
                       {"--results", "Evaluation folder of VSLAM-LAB, for an experiment file",
                        &arguments->results},
                       {"--truth", "Folder of the ground truths [that of the layout]", &arguments->truth},
                       {"--fit-scale", "Fit the scale to the ground truth: a folder of a monocular system",
                        &arguments->fit_scale}}},
          arguments, import_from),
      salvage_command(arguments)};
}

}  // namespace

Command store_command() {
  const auto arguments = std::make_shared<StoreArguments>();
  std::vector<Command> subcommands = run_subcommands(arguments);
  for (Command& command : maintenance_subcommands(arguments)) subcommands.push_back(std::move(command));
  for (Command& command : acceptance_commands()) subcommands.push_back(std::move(command));
  return {.name = "store",
          .summary = "Inspect, verify, merge, export and import stores of runs",
          .example = "store list build/bench/store.sqlite",
          .subcommands = std::move(subcommands)};
}

}  // namespace stillpoint::bench
