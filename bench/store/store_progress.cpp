// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/store_progress.h"

#include <sys/stat.h>

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

#include "bench/store/schema.h"
#include "bench/store/store_writer.h"

namespace stillpoint::bench {
namespace {

using std::chrono::system_clock;

double seconds_since_epoch(system_clock::time_point time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

/// A JSON list, which SQL takes as one parameter.
std::string json_names(const std::vector<LiveWorker>& workers) {
  nlohmann::json names = nlohmann::json::array();
  for (const LiveWorker& worker : workers) names.push_back(worker.name);
  return names.dump();
}

std::vector<PlanProgress> plan_counts(const Database& database) {
  std::vector<PlanProgress> plans;
  Statement rows = database.prepare(
      "SELECT plan.name, plan.title, count(*), count(run.outcome), "
      "count(CASE WHEN run.outcome <> 'ok' THEN 1 END) FROM plan JOIN plan_entry ON plan_entry.plan = "
      "plan.name "
      "LEFT JOIN run ON run.key = plan_entry.run_key GROUP BY plan.name ORDER BY plan.name");
  while (rows.step()) {
    plans.push_back({.name = rows.text(0),
                     .title = rows.text(1),
                     .runs = rows.integer(2),
                     .ended = rows.integer(3),
                     .failed = rows.integer(4)});
  }
  return plans;
}

/// What the live workers have done for a plan.
struct LiveRuns {
  std::int64_t ended = 0;
  double last_s = 0.0;  ///< end of the last one, since the epoch
};

/// By plan; only those of which a live worker executes or has executed a run.
std::map<std::string, LiveRuns> live_runs(const Database& database, const std::string& workers) {
  std::map<std::string, LiveRuns> runs;
  Statement rows = database.prepare(
      "SELECT plan_entry.plan, count(run.ended), coalesce(max(CAST(strftime('%s', run.ended) AS INTEGER)), "
      "0) "
      "FROM run JOIN plan_entry ON plan_entry.run_key = run.key "
      "WHERE run.worker IN (SELECT value FROM json_each(?)) GROUP BY plan_entry.plan");
  rows.bind(workers);
  while (rows.step()) runs[rows.text(0)] = {rows.integer(1), static_cast<double>(rows.integer(2))};
  return runs;
}

/// Time per run from the start of the workers to the end of their last run; the remaining time counts down
/// from there.
void add_rate(PlanProgress& plan, const LiveRuns& live, double start_s, double now_s) {
  plan.is_executed = true;
  const double seconds = live.last_s - start_s;
  if (live.ended == 0 || seconds <= 0.0) return;
  plan.runs_per_s = static_cast<double>(live.ended) / seconds;
  const double from_last_s = static_cast<double>(plan.runs - plan.ended) / *plan.runs_per_s;
  plan.remaining_s = std::max(0.0, from_last_s - (now_s - live.last_s));
}

std::vector<RunningRun> running_runs(const Database& database, const std::string& workers, double now_s) {
  std::vector<RunningRun> runs;
  Statement rows = database.prepare(
      "SELECT system, variant, sequence, seed, repetition, axis, axis_value, "
      "CAST(strftime('%s', started) AS INTEGER) FROM run WHERE state = 'running' AND "
      "worker IN (SELECT value FROM json_each(?)) ORDER BY started, id");
  rows.bind(workers);
  while (rows.step()) {
    RunningRun& run = runs.emplace_back();
    run.identity.system = rows.text(0);
    run.identity.variant = rows.text(1);
    run.identity.sequence = rows.text(2);
    run.identity.seed = rows.integer(3);
    run.identity.repetition = rows.integer(4);
    run.identity.axis = rows.text(5);
    run.identity.axis_value = rows.real(6);
    run.running_s = std::max(0.0, now_s - static_cast<double>(rows.integer(7)));
  }
  return runs;
}

std::vector<StoredRun> newest_runs(const Database& database, std::size_t limit) {
  std::vector<StoredRun> runs;
  Statement rows = database.prepare(std::string("SELECT ") + kRunColumns +
                                    " FROM run WHERE state = 'ended' ORDER BY ended DESC, id DESC LIMIT ?");
  rows.bind(static_cast<std::int64_t>(limit));
  while (rows.step()) runs.push_back(run_of(rows));
  return runs;
}

}  // namespace

namespace {

/// Device and inode; zeros without a file.
std::pair<std::uint64_t, std::uint64_t> inode_of(const std::filesystem::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return {0, 0};
  return {status.st_dev, status.st_ino};
}

}  // namespace

ProgressReader::ProgressReader(const std::filesystem::path& file)
    : store_(file), database_(file, DatabaseAccess::kRead), file_(inode_of(file)) {}

bool ProgressReader::is_replaced() const { return inode_of(store_.file()) != file_; }

bool ProgressReader::has_changed() {
  const std::int64_t version = database_.integer("PRAGMA data_version");
  const bool changed = version != version_;
  version_ = version;
  return changed;
}

StoreProgress ProgressReader::read(system_clock::time_point now, std::size_t max_newest) const {
  const std::vector<LiveWorker> workers = live_workers(store_.file());
  const double now_s = seconds_since_epoch(now);
  database_.execute("BEGIN");  // one snapshot of all tables
  StoreProgress progress{.workers = workers.size(),
                         .ended = database_.integer("SELECT count(*) FROM run WHERE state = 'ended'"),
                         .plans = plan_counts(database_),
                         .running = {},
                         .newest = newest_runs(database_, max_newest)};
  if (!workers.empty()) {  // a store with a live worker has the newest schema
    const double start_s = seconds_since_epoch(std::ranges::min(workers, {}, &LiveWorker::since).since);
    const std::string names = json_names(workers);
    progress.running = running_runs(database_, names, now_s);
    const std::map<std::string, LiveRuns> live = live_runs(database_, names);
    for (PlanProgress& plan : progress.plans) {
      if (const auto found = live.find(plan.name); found != live.end())
        add_rate(plan, found->second, start_s, now_s);
    }
    std::ranges::stable_partition(progress.plans, &PlanProgress::is_executed);
  }
  database_.execute("COMMIT");
  progress.newest = store_.with_details(std::move(progress.newest));
  return progress;
}

}  // namespace stillpoint::bench
