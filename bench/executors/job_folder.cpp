// SPDX-License-Identifier: BSD-3-Clause
#include "bench/executors/job_folder.h"

#include <algorithm>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "bench/process/file_lock.h"
#include "bench/record/output_folder.h"
#include "bench/store/maintenance/maintenance.h"
#include "bench/store/store.h"
#include "bench/systems/own_odometry.h"
#include "core/base/error.h"
#include "eval/io/text_reader.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPlanFile = "plan.toml";
constexpr const char* kBuildFile = "build";
constexpr const char* kLockFile = "lock";
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

std::vector<std::string> keys_in(const fs::path& file) {
  std::istringstream text(eval::read_text_file(file));
  std::vector<std::string> keys;
  for (std::string key; std::getline(text, key);) keys.push_back(key);
  return keys;
}

void remove_store(const fs::path& store) {
  fs::remove_all(files_folder(store));
  for (const char* suffix : {"-wal", "-shm", ""}) fs::remove(store.string() + suffix);
}

}  // namespace

void write_job(const fs::path& folder, const BenchPlan& plan,
               const std::vector<std::vector<std::string>>& tasks) {
  std::vector<OutputFile> files = {{kPlanFile, plan.text}, {kBuildFile, build_name() + "\n"}};
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    std::string& text =
        files.emplace_back(keys_file("", static_cast<int>(i) + 1).string(), std::string()).text;
    for (const std::string& key : tasks[i]) text += key + "\n";
  }
  fs::create_directories(folder);
  for (const fs::path& file : files_with(folder, kKeysPrefix)) fs::remove(file);
  write_files(folder, files);
}

std::vector<std::string> task_keys(const fs::path& folder, int task) {
  const fs::path file = keys_file(folder, task);
  if (!fs::exists(file))
    throw InputError(file.string(), "does not exist; write it with `stillpoint bench PLAN --executor`");
  return keys_in(file);
}

std::vector<std::string> all_task_keys(const fs::path& folder) {
  std::vector<std::string> all;
  for (const fs::path& file : files_with(folder, kKeysPrefix)) {
    for (std::string& key : keys_in(file)) all.push_back(std::move(key));
  }
  return all;
}

PlanMatrix job_matrix(const fs::path& folder, const std::vector<std::string>& keys) {
  PlanMatrix matrix = expand_plan(load_plan((folder / kPlanFile).string()), build_name(), {});
  std::set<std::string> remaining(keys.begin(), keys.end());
  // erase returns the number of removed keys: 0 for a run of another task
  std::erase_if(matrix.runs,
                [&](const PlannedRun& run) { return remaining.erase(run_key(run.identity)) == 0; });
  if (remaining.empty()) return matrix;
  std::string build = eval::read_text_file(folder / kBuildFile);
  while (build.ends_with('\n')) build.pop_back();
  throw InputError(
      folder.string(),
      build != build_name()
          ? fmt::format("was written by build {}, this program is build {}; install the same", build,
                        build_name())
          : fmt::format(
                "{} runs, e.g. {}, are not those of the plan on this machine; its recorded sequences, "
                "configs or system files differ",
                remaining.size(), *remaining.begin()));
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
    const MergeReport merged = merge_stores(file, store);
    report.added += merged.added;
    report.present += merged.present;
    remove_store(file);
  }
  return report;
}

}  // namespace stillpoint::bench
