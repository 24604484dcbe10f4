// SPDX-License-Identifier: BSD-3-Clause
// `stillpoint reproduce`: executes the plans of the paper's tables and of the datasets, and writes their
// tables.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "bench/analysis/run_groups.h"
#include "bench/analysis/run_statistics.h"
#include "bench/cli/command_line.h"
#include "bench/cli/console.h"
#include "bench/cli/data/fetch_progress.h"
#include "bench/cli/plan/plan_execution.h"
#include "bench/model/metrics.h"
#include "bench/plan/plan_matrix.h"
#include "bench/plan/sequence_registry.h"
#include "bench/record/output_folder.h"
#include "bench/store/find_run.h"
#include "bench/store/store.h"
#include "bench/systems/published_table.h"
#include "bench/systems/slam_system.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "datasets/open_sequence.h"
#include "eval/io/openloris_file.h"
#include "eval/openloris/benchmark.h"
#include "eval/trajectory/alignment.h"
#include "reports/drawing/drawing.h"
#include "reports/drawing/openloris_figure.h"
#include "reports/page/report_page.h"
#include "reports/tables/paper_tables.h"
#include "reports/tables/result_tables.h"
#include "reports/tables/table_formats.h"
#include "reports/text/evaluation_report.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = "openloris_";
/// Estimates and ground truth are written in the frame of the color camera; the calibration of each package
/// relates it to the recorded frame.
constexpr const char* kFrame = "d400_color";

/// "openloris_cafe1-2" -> cafe, 2.
struct SceneSequence {
  std::string scene;
  int number = 0;
};

std::optional<SceneSequence> scene_sequence(const std::string& name) {
  if (!name.starts_with(kPrefix)) return std::nullopt;
  const std::string rest = name.substr(kPrefix.size());
  const auto digit = std::ranges::find_if(rest, [](unsigned char c) { return std::isdigit(c) != 0; });
  const std::size_t dash = rest.find('-');
  if (digit == rest.end() || dash == std::string::npos) return std::nullopt;
  SceneSequence result{.scene = std::string(rest.begin(), digit)};
  const char* const end = rest.data() + rest.size();
  if (std::from_chars(rest.data() + dash + 1, end, result.number).ptr != end) return std::nullopt;
  return result;
}

/// Writes the ground truth of each scene. @return number of sequences
std::size_t write_ground_truth(const PlanMatrix& matrix, const fs::path& folder) {
  std::map<std::string, eval::OpenlorisFile> scenes;
  std::size_t count = 0;
  for (const PlanSequence& sequence : matrix.sequences) {
    const std::optional<SceneSequence> place = scene_sequence(sequence.name);
    if (!place || !sequence.unavailable_reason.empty()) continue;
    const std::unique_ptr<datasets::SensorStream> stream = datasets::open_sequence(sequence.folder);
    const datasets::GroundTruth& truth = stream->info().ground_truth;
    if (truth.trajectory.poses.empty()) continue;
    eval::OpenlorisFile& scene = scenes[place->scene];
    scene.scene = place->scene;
    scene.frame = kFrame;
    scene.sequences[place->number] = eval::move_to_frame(truth.trajectory, truth.T_c_f.inverse(), kFrame);
    ++count;
  }
  for (const auto& [name, scene] : scenes)
    write_files(folder, {{"gt_" + name + "_1.txt", eval::format_openloris(scene)}});
  return count;
}

/// Writes one file per completed run. @return their number
std::size_t write_results(const PlanMatrix& matrix, const Store& store, const fs::path& folder) {
  std::size_t count = 0;
  for (const StoredRun& run : store.plan_runs(matrix.plan.name)) {
    const std::optional<SceneSequence> place = scene_sequence(run.identity.sequence);
    if (!place || !run.blobs.contains("trajectory")) continue;
    Trajectory estimate = store.trajectory(run);
    if (estimate.poses.empty()) continue;
    eval::OpenlorisFile file{.scene = place->scene, .frame = kFrame};
    file.sequences.emplace(place->number, std::move(estimate));
    write_files(folder / folder_name(run.identity.variant),
                {{run.identity.sequence + ".txt", eval::format_openloris(file)}});
    ++count;
  }
  return count;
}

/// Scores the OpenLORIS runs of a plan by scene: the sequences of a scene are joined as in the tools of the
/// dataset (Shi et al., ICRA 2020), with one alignment and rates weighted by time.
/// Writes the trajectories and the ground truth in the format of the tools to OUT/openloris, and the figure
/// of the paper to OUT/openloris_figure.svg.
/// @return the table of scores; empty without a completed run
/// @throws InputError if a file cannot be read or written
std::string openloris_scene_table(const PlanMatrix& matrix, const Store& store, const fs::path& out) {
  const fs::path folder = out / "openloris";
  fs::remove_all(folder / "results");
  fs::remove_all(folder / "ground_truth");
  const std::size_t truths = write_ground_truth(matrix, folder / "ground_truth");
  if (truths == 0 || write_results(matrix, store, folder / "results") == 0) return "";
  const eval::OpenlorisEvaluation evaluation =
      eval::evaluate_openloris(folder / "results", folder / "ground_truth");
  const std::array figure{report::openloris_figure(evaluation.benchmark)};
  report::write_drawings(out / "openloris_figure.svg", figure, 1.0, {.force = true});
  return report::openloris_table(evaluation.benchmark, report::TableStyle::kMarkdown);
}

struct ReproduceArguments {
  std::string target;
  std::string store = "build/bench/reproduce.sqlite";
  std::string out = "build/reproduce";
  bool synthetic = false;
  bool real = false;
  bool get = false;
  bool accept_licence = false;
  std::string mirror;
  int jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
};

/// Whether a target is the key of a stored run, or its beginning.
bool is_run_key(const std::string& target) {
  constexpr std::size_t kShortest = 6;
  return target.size() >= kShortest && target.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// The description with which a run was executed. Its program and its other files must be as they were then.
ExternalSystem stored_system(const Store& store, const StoredRun& run) {
  const auto manifest = nlohmann::json::parse(store.manifest(run));
  const auto& system = manifest.at("system");
  if (!system.contains("description"))
    throw InputError("run " + run.key, "has no description; it was executed by an older version");
  // The name of the system may contain a plus, too.
  const std::vector<std::string> sets =
      parse_system_name(run.identity.variant.substr(run.identity.system.size())).sets;
  const fs::path file = fs::path(system.at("folder").get<std::string>()) / "stored.toml";
  ExternalSystem stored = parse_external_system(system.at("description").get<std::string>(), file, sets);
  if (stored.hash != run.identity.config_hash)
    throw InputError("run " + run.key, "cannot be repeated: its program, template or scripts below " +
                                           stored.folder + " changed since");
  return stored;
}

/// The runs of the plan of a stored run.
/// @throws InputError if a file that it names, such as a description, is missing or invalid
PlanMatrix expanded_again(const fs::path& plan, const StoredRun& run) {
  try {
    return expand_plan(load_plan(plan.string()), build_name(), {});
  } catch (const InputError& error) {
    throw InputError(
        "run " + run.key,
        fmt::format("cannot be repeated: the files that its plan names, such as descriptions, must "
                    "exist where they were, and be valid: {}",
                    error.what()));
  }
}

/// Whether a plan has the run, with any build and config: an entry of a plan is the run of the newest ones.
bool has_run(const Store& store, const StoredPlan& plan, const StoredRun& run) {
  const std::string planned = planned_key(run.identity);
  return std::ranges::any_of(store.plan_runs(plan.name),
                             [&](const StoredRun& other) { return planned_key(other.identity) == planned; });
}

/// The stored run as a plan of one run.
/// @param folder receives the text of its plan
PlanMatrix matrix_of_run(const Store& store, const StoredRun& run, const fs::path& folder) {
  const bool is_own = run.identity.system == kOwnSystem;
  bool is_planned = false;
  for (const StoredPlan& plan : store.plans()) {
    if (!has_run(store, plan, run)) continue;
    is_planned = true;
    write_files(folder, {{plan.name + ".toml", plan.text}});
    PlanMatrix matrix = expanded_again(folder / (plan.name + ".toml"), run);
    std::erase_if(matrix.runs, [&](PlannedRun& planned) {
      if (!is_own && planned.identity.variant == run.identity.variant) {
        planned.identity.build = run.identity.build;
        planned.identity.config_hash = run.identity.config_hash;
      }
      return run_key(planned.identity) != run.key;
    });
    if (matrix.runs.empty()) continue;
    if (!is_own) matrix.systems.at(matrix.runs.front().system) = stored_system(store, run);
    return matrix;
  }
  if (!is_planned) throw InputError("run " + run.key, "belongs to no plan of the store");
  throw InputError(
      "run " + run.key,
      fmt::format("cannot be repeated: it was executed by build {}, or with other data or another "
                  "config than today's; `stillpoint history` with another --store executes a "
                  "commit again, and `stillpoint stats repeat --with` compares both",
                  run.identity.build));
}

/// Prints how a run differs from its repetition. @return findings if it does
int print_difference(const ExecutionDifference& row) {
  const auto ate = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.6f} m", *value) : std::string("n/a");
  };
  std::string text = "equal trajectories";
  if (!row.failure.empty()) text = row.failure;
  if (row.failure.empty() && !row.equal_trajectories)
    text = fmt::format("trajectories differ by at most {:.2g} m", row.largest_m);
  std::cout << fmt::format("{}: {}; ATE {}, repeated {}\n", row.label, text, ate(row.ate_m),
                           ate(row.other_ate_m));
  return row.failure.empty() && row.equal_trajectories ? kExitOk : kExitFindings;
}

/// Executes a stored run again, and compares the trajectories.
int reproduce_run(const ReproduceArguments& arguments) {
  const Store store(arguments.store);
  const StoredRun run = find_run(store, arguments.target);
  const fs::path folder = fs::path(arguments.out) / run.key;
  const fs::path file = folder / "run.sqlite";
  require_safe_folder(folder, {.names = {"run.sqlite", "run.sqlite.files"}, .marks = {{"run.sqlite"}}},
                      {arguments.store});
  require_writable(folder);
  fs::remove_all(files_folder(file));
  for (const char* const suffix : {"-wal", "-shm", ""}) fs::remove(file.string() + suffix);
  install_interrupt_handlers();
  const PlanMatrix matrix = matrix_of_run(store, run, folder);
  {
    StoreWriter writer(file);
    if (run_plan(matrix, writer, {}, plan_progress()).interrupted) return kExitInterrupted;
  }
  const std::vector<ExecutionDifference> rows = execution_differences(store, std::span(&run, 1), Store(file));
  if (rows.empty()) throw InputError("run " + run.key, "was not executed: its sequence is not available");
  return print_difference(rows.front());
}

/// A table or figure, and the plans that reproduce it.
struct Target {
  const char* name;
  const char* synthetic_plan;  ///< empty = none
  const char* real_plan;
};
constexpr Target kTargets[] = {{"table1", "table1_tum_synthetic", "table1_tum"},
                               {"table2", "table2_ablation_synthetic", "table2_ablation"},
                               {"table3", "table3_runtime", "table3_runtime_real"},
                               {"openloris", "openloris_synthetic", "openloris"},
                               {"bonn", "", "bonn"},
                               {"vcu_rvi", "", "vcu_rvi"}};

std::vector<Target> select_targets(const std::string& name) {
  std::vector<Target> targets;
  std::string known;
  for (const Target& target : kTargets) {
    if (name == "all" || name == target.name) targets.push_back(target);
    known += std::string(target.name) + ", ";
  }
  if (targets.empty())
    throw InputError("unknown target \"" + name + "\"; expected one of: " + known +
                     "all, or the key of a run in the store (`stillpoint store list`)");
  return targets;
}

/// Prints the missing sequences of a target, if any.
void print_missing_data(const Target& target, const PlanMatrix& matrix) {
  std::string missing;
  for (const PlanSequence& sequence : matrix.sequences) {
    if (!sequence.unavailable_reason.empty()) missing += "  " + sequence.unavailable_reason + "\n";
  }
  if (missing.empty()) return;
  std::cout << fmt::format("{}: missing data:\n{}`stillpoint data get --for {}` fetches all of it.\n\n",
                           target.name, missing, matrix.plan.name);
}

/// Fetches what the plan lacks. What cannot be fetched is named, and remains empty rows. @return false if
/// interrupted
bool fetch_data(const Target& target, const ReproduceArguments& arguments) {
  const std::vector<datasets::CatalogueDataset> catalogues = load_catalogues();
  std::vector<datasets::CatalogueEntry> entries = plan_entries(target.real_plan, catalogues);
  const auto is_manual = [](const datasets::CatalogueEntry& entry) {
    return !entry.dataset->manual.empty() && !is_available(*entry.dataset, *entry.sequence);
  };
  const auto manual = std::ranges::find_if(entries, is_manual);
  if (manual != entries.end()) std::cout << manual->dataset->title << ": " << manual->dataset->manual << "\n";
  std::erase_if(entries, is_manual);
  if (entries.empty()) return true;
  FetchOptions options;
  options.mirror = arguments.mirror;
  options.record_boxes = true;
  const FetchResult result = fetch_with_progress(
      entries, options, arguments.accept_licence ? LicenceAnswer::kAccepted : LicenceAnswer::kAsk);
  for (const std::string& problem : result.problems) spdlog::warn("{}", problem);
  return !result.stopped;
}

/// Executes the runs of a plan that are not in the store. @return false if interrupted
bool execute_runs(const Target& target, const PlanMatrix& matrix, const ReproduceArguments& arguments) {
  print_missing_data(target, matrix);
  StoreWriter writer(arguments.store);
  const PlanReport report =
      run_plan(matrix, writer, {.jobs = arguments.jobs, .retry = false}, plan_progress());
  std::cout << fmt::format("{}: {} of {} executed, {} cached, {} skipped\n", target.name, report.executed,
                           counted(matrix.runs.size(), "run"), report.cached, report.missing);
  if (report.profile.runs > 0) std::cout << profile_text(report.profile);
  return !report.interrupted;
}

/// The tables of a target: that of the paper, or those of the sequences of a plan with recordings, or those
/// of all metrics.
std::vector<report::ReportTable> target_tables(const Target& target, const PlanMatrix& matrix,
                                               const std::vector<StoredRun>& runs) {
  if (const auto paper = report::paper_table_of(matrix.plan.name)) return {report::paper_table(*paper, runs)};
  if (matrix.plan.name != target.real_plan) return report::metric_tables(runs);
  report::DatasetTableLayout layout{
      .name = target.name, .title = matrix.plan.title, .sequences = {}, .variants = matrix.plan.variants};
  for (const PlanSequence& sequence : matrix.sequences) layout.sequences.push_back(sequence.name);
  PublishedTable published;
  published.metric = headline_metric().id;
  if (!matrix.plan.table.published.empty()) published = load_published(matrix.plan.table.published.front());
  return {report::dataset_table(layout, runs, published)};
}

/// Writes the tables of a target and prints the first one.
void write_tables(const Target& target, const std::vector<report::ReportTable>& tables, const fs::path& out) {
  std::vector<OutputFile> files;
  std::string latex;
  for (const report::ReportTable& table : tables) {
    for (OutputFile& file : report::table_files(table)) {
      if (!file.name.starts_with(target.name)) file.name = std::string(target.name) + "_" + file.name;
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

enum class TargetResult { kComplete, kSkipped, kInterrupted };

TargetResult reproduce_target(const Target& target, const ReproduceArguments& arguments) {
  const std::string plan = arguments.real ? target.real_plan : target.synthetic_plan;
  if (plan.empty()) {
    std::cout << fmt::format("{} has no plan for rendered sequences; specify --real.\n", target.name);
    return TargetResult::kSkipped;
  }
  if (arguments.get && !fetch_data(target, arguments)) return TargetResult::kInterrupted;
  const PlanMatrix matrix = expand_plan(load_plan(plan), build_name(), {});
  const bool finished = execute_runs(target, matrix, arguments);
  const Store store(arguments.store);
  write_tables(target, target_tables(target, matrix, store.plan_runs(plan)), arguments.out);
  if (finished && arguments.real && std::string(target.name) == "openloris")
    std::cout << openloris_scene_table(matrix, store, arguments.out);
  return finished ? TargetResult::kComplete : TargetResult::kInterrupted;
}

int reproduce(const ReproduceArguments& arguments) {
  if (is_run_key(arguments.target)) return reproduce_run(arguments);
  if (arguments.real && arguments.synthetic)
    throw InputError("--real", "cannot be combined with --synthetic");
  if (arguments.get && !arguments.real) throw InputError("--get", "requires --real");
  const std::vector<Target> targets = select_targets(arguments.target);
  const fs::path out = arguments.out;
  require_safe_tables(targets, out, arguments.store);
  require_writable(out);
  install_interrupt_handlers();
  bool complete = true;
  std::size_t number = 0;
  for (const Target& target : targets) {
    std::cout << fmt::format("{} ({} of {})\n", target.name, ++number, targets.size()) << std::flush;
    const TargetResult result = reproduce_target(target, arguments);
    if (result == TargetResult::kInterrupted) return kExitInterrupted;
    const bool is_optional = arguments.target == "all" && std::string(target.synthetic_plan).empty();
    complete = complete && (result == TargetResult::kComplete || is_optional);
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
      .summary = "Reproduce a table of the paper, or repeat a stored run of any system",
      .example = "reproduce table2 --synthetic --jobs 2",
      .options = {{"TARGET",
                   "table1, table2, table3, openloris, bonn, vcu_rvi or all; or the key of a run in --store",
                   &arguments->target},
                  {"--synthetic", "Use rendered sequences [default]", &arguments->synthetic},
                  {"--real", "Use recorded sequences; missing ones are named and remain empty rows",
                   &arguments->real},
                  {"--get",
                   "First download what is missing and record boxes, see `stillpoint data get --boxes`",
                   &arguments->get},
                  {"--accept-licence", "Accept the licences of the datasets", &arguments->accept_licence},
                  {"--mirror", "As in `stillpoint data get`", &arguments->mirror},
                  {"--store", "Database of runs [build/bench/reproduce.sqlite]", &arguments->store},
                  {"--out", "Output folder of tables and the HTML report [build/reproduce]", &arguments->out},
                  {"--jobs",
                   "Number of concurrent accuracy runs [number of processors]",
                   &arguments->jobs,
                   {1, 1000}}},
      .action = [arguments] { return reproduce(*arguments); }};
}

}  // namespace stillpoint::bench
