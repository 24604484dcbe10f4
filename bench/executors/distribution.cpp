// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/distribution.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "bench/config/config_file.h"
#include "bench/executors/hosts.h"
#include "bench/plan/execution/run_cost.h"
#include "bench/process/file_lock.h"
#include "bench/record/output_folder.h"
#include "bench/store/store.h"
#include "bench/systems/slam_system.h"
#include "core/base/content_hash.h"
#include "core/base/counted.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlanFile = "plan.toml";
constexpr const char* kBuildFile = "build";
constexpr const char* kLockFile = "lock";
constexpr const char* kSystemsFile = "systems";
constexpr const char* kFilesFile = "files";
constexpr std::string_view kCopiedConfigPrefix = "config-";
constexpr std::string_view kCopiedTablePrefix = "published-";
constexpr std::string_view kSystemPrefix = "system-";
constexpr std::string_view kKeysPrefix = "keys-";
constexpr std::string_view kStorePrefix = "store-";

fs::path keys_file(const fs::path& folder, int task) {
  return folder / (std::string(kKeysPrefix) + std::to_string(task));
}

fs::path task_store(const fs::path& folder, int task) {
  return folder / fmt::format("{}{}.sqlite", kStorePrefix, task);
}

/// Files in a folder whose names have a prefix, sorted.
std::vector<fs::path> files_with(const fs::path& folder, std::string_view prefix) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && entry.path().filename().string().starts_with(prefix))
      found.push_back(entry.path());
  }
  std::ranges::sort(found);
  return found;
}

std::vector<std::string> lines_of(const fs::path& file) {
  std::istringstream text(eval::read_text_file(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

/// Whether a text names a path that the folder of the description determines.
bool depends_on_folder(const ExternalSystem& system, const std::string& text) {
  const auto has = [&text](const char* name) { return text.find(name) != std::string::npos; };
  const bool is_own_source = fs::path(system.source.git).is_relative();
  return has("{here}") || (is_own_source && (has("{source}") || has("{binary}")));
}

/// The words that lead elsewhere in a copy of a description and its files: to a folder, to a file that is not
/// copied, or out of the folder of the description.
std::vector<std::string> misleading_words(const ExternalSystem& system) {
  std::vector<std::string> words;
  const auto is_relative = [](const std::string& path) { return !path.starts_with('{') && path[0] != '/'; };
  for (const std::string& word : system.command) {
    const bool is_program = &word == &system.command.front() && word.find('/') != std::string::npos;
    const std::string path = with_folders(system, word);
    const fs::path file = is_program ? program_of(system, path) : path;
    const bool is_copied = fs::is_regular_file(file) && !path_below(system, file).empty();
    if (((is_program && is_relative(word)) || depends_on_folder(system, word)) && !is_copied)
      words.push_back(word);
  }
  for (const std::string& variable : system.environment) {
    if (depends_on_folder(system, variable)) words.push_back(variable);
  }
  if (is_relative(system.working_folder) || depends_on_folder(system, system.working_folder))
    words.push_back(system.working_folder);
  if (system.calibration_template.empty()) return words;
  const fs::path source = fs::path(system.folder) / system.calibration_template;
  if (path_below(system, source).empty() || depends_on_folder(system, eval::read_text_file(source)))
    words.push_back(system.calibration_template);
  return words;
}

/// Copies a description and the files that determine its runs; files with an absolute path belong to the
/// machines.
/// @return its path in the job folder, with its parameter sets
/// @throws InputError if the copy would be another system
std::string copy_system(const std::string& name, const fs::path& folder, std::size_t index) {
  const fs::path file = parse_system_name(name).file;
  const ExternalSystem system = load_external_system(name);
  const std::vector<std::string> words = misleading_words(system);
  if (!words.empty())
    throw InputError(system.path,
                     "\"" + words.front() +
                         "\" cannot be copied to another machine: it is, or contains, a folder or a "
                         "path outside of the folder of the description; use a word that is one "
                         "file below {here}, or an absolute path that each machine has");
  const fs::path target = std::string(kSystemPrefix) + std::to_string(index);
  std::vector<std::string> files = files_of(system);
  files.push_back(fs::absolute(file).string());
  for (const std::string& source : files) {
    const std::string relative = path_below(system, source);
    if (relative.empty()) continue;
    fs::create_directories((folder / target / relative).parent_path());
    fs::copy_file(source, folder / target / relative, fs::copy_options::overwrite_existing);
  }
  return (target / file.filename()).string() + name.substr(file.string().size());
}

/// The descriptions in the job folder; empty if the plan has none.
std::vector<std::string> copied_systems(const fs::path& folder) {
  std::vector<std::string> systems;
  if (!fs::exists(folder / kSystemsFile)) return systems;
  for (const std::string& name : lines_of(folder / kSystemsFile))
    systems.push_back(name.starts_with(kSystemPrefix) ? (folder / name).string() : name);
  return systems;
}

/// Copies a config and the files that it inherits. @return its path in the job folder
std::string copy_config(const std::string& name, const fs::path& folder, std::size_t index) {
  const std::vector<std::string> files = files_of_config(name);
  fs::path common = fs::path(files.front()).parent_path();
  for (const std::string& file : files) {
    while (fs::path(file).lexically_relative(common).native().starts_with("../"))
      common = common.parent_path();
  }
  const fs::path target = std::string(kCopiedConfigPrefix) + std::to_string(index);
  fs::remove_all(folder / target);
  for (const std::string& file : files) {
    const fs::path copy = folder / target / fs::path(file).lexically_relative(common);
    fs::create_directories(copy.parent_path());
    fs::copy_file(file, copy);
  }
  return (target / fs::path(files.front()).lexically_relative(common)).string();
}

/// Copies a published table. @return its path in the job folder
std::string copy_table(const std::string& file, const fs::path& folder, std::size_t index) {
  const std::string target = std::string(kCopiedTablePrefix) + std::to_string(index) + ".toml";
  fs::copy_file(file, folder / target, fs::copy_options::overwrite_existing);
  return target;
}

/// Text of the file `kFilesFile`; copies configs and published tables if the workers do not share the file
/// system.
std::string files_text(const fs::path& folder, const BenchPlan& plan, SystemFiles system_files) {
  std::string text;
  std::size_t index = 0;
  for (const auto& [name, found] : plan.files) {
    std::string path = fs::absolute(found).string();
    if (system_files == SystemFiles::kCopied) {
      const bool is_table = std::ranges::find(plan.table.published, found) != plan.table.published.end();
      if (!name.ends_with(".toml"))
        path = (fs::path("data") / fs::canonical(found).filename()).string();
      else
        path = is_table ? copy_table(found, folder, index++) : copy_config(found, folder, index++);
    }
    text += name + "\n" + path + "\n";
  }
  return text;
}

/// `BenchPlan::files` on this machine.
std::map<std::string, std::string> job_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  if (!fs::exists(folder / kFilesFile)) return files;
  const std::vector<std::string> lines = lines_of(folder / kFilesFile);
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2) files[lines[i]] = (folder / lines[i + 1]).string();
  return files;
}

void remove_store(const fs::path& store) {
  fs::remove_all(files_folder(store));
  for (const char* suffix : {"-wal", "-shm", ""}) fs::remove(store.string() + suffix);
}

}  // namespace

void write_job(const fs::path& folder, const BenchPlan& plan,
               const std::vector<std::vector<std::string>>& tasks, SystemFiles system_files) {
  std::vector<OutputFile> files = {{kPlanFile, plan.text}, {kBuildFile, build_name() + "\n"}};
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    files.push_back({keys_file("", static_cast<int>(i) + 1).string(), {}});
    for (const std::string& key : tasks[i]) files.back().text += key + "\n";
  }
  fs::create_directories(folder);
  for (const fs::path& file : files_with(folder, kKeysPrefix)) fs::remove(file);
  std::string systems;
  for (std::size_t i = 0; i < plan.systems.size(); ++i) {
    fs::remove_all(folder / (std::string(kSystemPrefix) + std::to_string(i)));
    const std::string& name = plan.systems[i];
    const fs::path file = parse_system_name(name).file;
    if (file.extension() != ".toml")
      systems += name;  // an embedded one
    else if (system_files == SystemFiles::kShared)
      systems += fs::absolute(name).string();
    else
      systems += copy_system(name, folder, i);
    systems += "\n";
  }
  files.push_back({kSystemsFile, systems});
  files.push_back({kFilesFile, files_text(folder, plan, system_files)});
  write_files(folder, files);
}

std::vector<std::string> task_keys(const fs::path& folder, int task) {
  const fs::path file = keys_file(folder, task);
  if (!fs::exists(file))
    throw InputError(file.string(), "does not exist; write it with `stillpoint bench PLAN --executor`");
  return lines_of(file);
}

std::vector<std::string> all_task_keys(const fs::path& folder) {
  std::vector<std::string> all;
  for (const fs::path& file : files_with(folder, kKeysPrefix)) {
    for (std::string& key : lines_of(file)) all.push_back(std::move(key));
  }
  return all;
}

PlanMatrix job_matrix(const fs::path& folder, const std::vector<std::string>& keys) {
  PlanMatrix matrix = expand_plan(
      load_plan((folder / kPlanFile).string(), copied_systems(folder), job_files(folder)), build_name(), {});
  std::set<std::string> remaining(keys.begin(), keys.end());
  // erase returns the number of removed keys: 0 for a run of another task
  std::erase_if(matrix.runs,
                [&](const PlannedRun& run) { return remaining.erase(run_key(run.identity)) == 0; });
  if (remaining.empty()) return matrix;
  std::string build = eval::read_text_file(folder / kBuildFile);
  while (build.ends_with('\n')) build.pop_back();
  throw InputError(folder.string(),
                   build != build_name()
                       ? fmt::format("was written by build {}, this program is build {}; install the same",
                                     build, build_name())
                       : fmt::format("has {} (e.g. {}) that the plan on this machine does not have; its "
                                     "recorded sequences, configs or "
                                     "system files differ",
                                     counted(remaining.size(), "run"), *remaining.begin()));
}

PlanReport run_task(const fs::path& folder, int task, int jobs, const PlanHooks& hooks) {
  const FileLock lock(folder / kLockFile, LockKind::kShared);
  const PlanMatrix matrix = job_matrix(folder, task_keys(folder, task));
  StoreWriter writer(task_store(folder, task));
  return run_plan(matrix, writer, {.jobs = jobs, .retry = false, .record = false}, hooks);
}

void wait_for_workers(const fs::path& folder) {
  const FileLock lock(folder / kLockFile, LockKind::kExclusive);
}

MergeReport merge_tasks(const fs::path& folder, const fs::path& store) {
  const FileLock lock(folder / kLockFile, LockKind::kExclusive);
  MergeReport report;
  for (const fs::path& file : files_with(folder, kStorePrefix)) {
    if (file.extension() != ".sqlite") continue;
    // Completes a store whose worker was killed while it created it.
    static_cast<void>(StoreWriter(file));
    MergeReport merged = merge_stores(file, store);
    report.added += merged.added;
    report.present += merged.present;
    std::ranges::move(merged.contradicting, std::back_inserter(report.contradicting));
    remove_store(file);
  }
  return report;
}

namespace {

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

bool is_available(const PlanMatrix& matrix, const PlannedRun& run) {
  return matrix.sequences[run.sequence].unavailable_reason.empty();
}

/// The matrix with its runs that are available and not completed.
PlanMatrix pending_runs(PlanMatrix matrix, const StoreWriter& writer) {
  std::erase_if(matrix.runs, [&](const PlannedRun& run) {
    return !is_available(matrix, run) || writer.is_done(run_key(run.identity));
  });
  return matrix;
}

/// Keys of the runs of each task: consecutive runs of the plan with about equal expected duration.
std::vector<std::vector<std::string>> divide_runs(const PlanMatrix& pending,
                                                  const DistributionOptions& options) {
  std::vector<double> seconds;
  for (const RunCost& cost : expected_costs(pending, Store(options.store).runs()))
    seconds.push_back(cost.seconds);
  const std::vector<std::size_t> bounds = divide_evenly(seconds, options.tasks);
  std::vector<std::vector<std::string>> tasks(bounds.size() - 1);
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    for (std::size_t run = bounds[task]; run < bounds[task + 1]; ++run)
      tasks[task].push_back(run_key(pending.runs[run].identity));
  }
  return tasks;
}

void require_class(const PlanMatrix& matrix, const DistributionOptions& options) {
  if (!options.machine_class.empty() && !is_host_word(options.machine_class))
    throw InputError("--machine-class",
                     "\"" + options.machine_class + "\" must consist of letters, digits and _ . -");
  if (matrix.plan.kind == RunKind::kTiming && options.machine_class.empty())
    throw InputError("--machine-class",
                     "is required for a timing plan, as times of different machines are not comparable");
}

PlanReport report_of(const PlanMatrix& matrix, const StoreWriter& writer) {
  PlanReport report;
  for (const PlannedRun& run : matrix.runs) {
    if (!is_available(matrix, run))
      ++report.missing;
    else if (writer.is_done(run_key(run.identity)))
      ++report.cached;
  }
  return report;
}

}  // namespace

fs::path job_folder(const BenchPlan& plan, const fs::path& store) {
  fs::create_directories(fs::absolute(store).parent_path());
  const fs::path file = fs::weakly_canonical(fs::absolute(store));
  const std::string identity = host_name() + '\n' + file.string() + '\n' + plan.name;
  fs::path folder = file.string() + ".jobs/" + hash_text(content_hash(identity));
  fs::create_directories(folder);
  return folder;
}

PlanReport distribute_plan(const PlanMatrix& matrix, const DistributionOptions& options,
                           const Executor& executor) {
  require_recorded_boxes(matrix);
  require_class(matrix, options);
  const fs::path folder = job_folder(matrix.plan, options.store);
  const fs::path calling = folder / "calling";
  if (is_locked(calling) && options.on_step)
    options.on_step("wait for another call that executes this plan for this store");
  const FileLock lock(calling, LockKind::kExclusive, options.stop_requested);
  if (options.stop_requested()) {
    PlanReport report = report_of(matrix, StoreWriter(options.store));
    report.interrupted = true;
    return report;
  }
  executor.collect();
  std::size_t cached = 0;
  std::vector<std::vector<std::string>> tasks;
  {
    StoreWriter writer(options.store);
    prepare_store(matrix, writer, {.retry = options.retry});
    cached = report_of(matrix, writer).cached;
    const PlanMatrix pending = pending_runs(matrix, writer);
    if (!pending.runs.empty()) tasks = divide_runs(pending, options);
  }
  if (!tasks.empty() && !options.stop_requested()) {
    write_job(folder / "job", matrix.plan, tasks, executor.system_files);
    executor.execute(static_cast<int>(tasks.size()));
    if (!options.stop_requested()) executor.collect();
  }
  PlanReport report = report_of(matrix, StoreWriter(options.store));
  report.executed = report.cached - cached;
  report.cached = cached;
  report.interrupted = options.stop_requested();
  return report;
}

namespace {

struct Worker {
  double idle_at_s = 0.0;
  std::set<std::size_t> sequences;  ///< that it has prepared
};

/// Uniform in [1 - variation, 1 + variation].
double duration_factor(std::size_t run, double variation) {
  const double uniform = static_cast<double>(mix_bits(static_cast<std::uint64_t>(run)) >> 11) * 0x1p-53;
  return 1.0 + variation * (2.0 * uniform - 1.0);
}

}  // namespace

std::vector<SimulatedRun> repeated(std::span<const SimulatedRun> runs, std::size_t times) {
  std::vector<SimulatedRun> all;
  for (const SimulatedRun& run : runs) all.insert(all.end(), times, run);
  return all;
}

SimulatedPlan simulate_plan(std::span<const SimulatedRun> runs, int workers, int tasks,
                            const ScalingCosts& costs) {
  STILLPOINT_CHECK(!runs.empty() && workers > 0 && tasks > 0);
  std::vector<double> expected_s;
  for (const SimulatedRun& run : runs) expected_s.push_back(run.seconds);
  const std::vector<std::size_t> bounds = divide_evenly(expected_s, tasks);
  std::vector<Worker> pool(static_cast<std::size_t>(workers));
  SimulatedPlan plan{.runs = runs.size()};
  for (std::size_t task = 0; task + 1 < bounds.size(); ++task) {
    Worker& worker = *std::ranges::min_element(pool, {}, &Worker::idle_at_s);
    double preparing_s = 0.0;
    double executing_s = 0.0;
    for (std::size_t run = bounds[task]; run < bounds[task + 1]; ++run) {
      if (worker.sequences.insert(runs[run].sequence).second) preparing_s += costs.prepare_s;
      executing_s += runs[run].seconds * duration_factor(run, costs.variation);
    }
    worker.idle_at_s += costs.task_start_s + preparing_s + executing_s;
    plan.starting_s += costs.task_start_s / workers;
    plan.preparing_s += preparing_s / workers;
    plan.executing_s += executing_s / workers;
  }
  const double end_s = std::ranges::max_element(pool, {}, &Worker::idle_at_s)->idle_at_s;
  plan.waiting_s = end_s - plan.starting_s - plan.preparing_s - plan.executing_s;
  plan.merging_s = costs.merge_s * static_cast<double>(runs.size());
  return plan;
}

}  // namespace stillpoint::bench
