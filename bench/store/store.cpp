// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/store.h"

#include <algorithm>
#include <tuple>
#include <unordered_map>

#include "bench/model/run_csv.h"
#include "bench/store/schema.h"
#include "core/base/error.h"
#include "eval/io/trajectory_file.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSelected =
    "WHERE state = 'ended' AND ?1 IN ('', system) AND ?2 IN ('', variant) AND ?3 IN ('', sequence) "
    "AND build >= ?4 AND substr(build, 1, length(?4)) = ?4 AND ?5 IN ('', kind) ORDER BY started, id";

/// Commit time and machine of the runs, from their manifests.
std::vector<StoredRun> with_origins(const Database& database, std::vector<StoredRun> runs) {
  std::unordered_map<std::string, std::pair<std::string, std::string>> origins;
  Statement rows = database.prepare(
      "SELECT hash, json_extract(json, '$.build.git_time'), json_extract(json, '$.host.cpu'), "
      "json_extract(json, '$.host.logical_cpus') FROM manifest WHERE json_valid(json)");
  while (rows.step()) {
    const std::string cpu = rows.text(2);
    const std::int64_t count = rows.integer(3);
    const std::string machine =
        cpu.empty() || count <= 0 ? cpu : cpu + ", " + std::to_string(count) + " processors";
    origins[rows.text(0)] = {rows.text(1), machine};
  }
  for (StoredRun& run : runs) {
    const auto found = origins.find(run.manifest_hash);
    if (found != origins.end()) std::tie(run.committed, run.machine) = found->second;
  }
  return runs;
}

/// The runs with their rows of the tables that reference them; reads the rows of their range of ids in one
/// pass.
std::vector<StoredRun> with_rows(const Database& database, std::vector<StoredRun> runs) {
  if (runs.empty()) return runs;
  std::unordered_map<std::int64_t, StoredRun*> by_id;
  for (StoredRun& run : runs) {
    by_id[run.id] = &run;
    run.metrics.clear();
    run.costs.clear();
    run.blobs.clear();
  }
  const auto range = std::ranges::minmax(runs, {}, &StoredRun::id);
  const auto run_at = [&](const Statement& row) {
    const auto found = by_id.find(row.integer(0));
    return found == by_id.end() ? nullptr : found->second;
  };
  const auto prepared = [&](const std::string& columns, const std::string& table, const std::string& order) {
    Statement rows = database.prepare("SELECT " + columns + " FROM " + table +
                                      " WHERE run BETWEEN ? AND ? ORDER BY " + order);
    rows.bind(range.min.id).bind(range.max.id);
    return rows;
  };
  const std::string protocol = protocol_column(database);
  Statement metrics =
      prepared("run, name, " + protocol + ", unit, value", "metric", "run, name, " + protocol);
  while (metrics.step()) {
    if (StoredRun* run = run_at(metrics)) run->metrics.push_back(metric_of(metrics));
  }
  Statement costs = prepared(kCostColumns, "timing", "run, module");
  while (costs.step()) {
    if (StoredRun* run = run_at(costs)) run->costs.push_back(cost_of(costs));
  }
  Statement blobs = prepared("run, kind, blob", "attachment", "run, kind");
  while (blobs.step()) {
    if (StoredRun* run = run_at(blobs)) run->blobs[current_kind(blobs.text(1))] = blobs.text(2);
  }
  return runs;
}

/// Whether a trajectory file contains poses; that of a run without poses contains only comments.
bool has_rows(std::string_view text) {
  while (!text.empty()) {
    const std::string_view line = cut_front(text, '\n');
    if (!line.empty() && line.front() != '#') return true;
  }
  return false;
}

}  // namespace

fs::path files_folder(const fs::path& store_file) { return store_file.string() + ".files"; }

Store::Store(const fs::path& file)
    : database_(file, DatabaseAccess::kRead), blobs_(files_folder(file) / "blobs") {
  require_readable_schema(database_);
}

std::vector<StoredRun> Store::run_headers(const RunFilter& filter) const {
  std::vector<StoredRun> runs;
  Statement rows = database_.prepare(std::string("SELECT ") + kRunColumns + " FROM run " + kSelected);
  rows.bind(filter.system).bind(filter.variant).bind(filter.sequence).bind(filter.build).bind(filter.kind);
  while (rows.step()) runs.push_back(run_of(rows));
  return with_origins(database_, std::move(runs));
}

std::vector<StoredRun> Store::with_details(std::vector<StoredRun> runs) const {
  return with_rows(database_, std::move(runs));
}

std::vector<StoredRun> Store::runs(const RunFilter& filter) const {
  database_.execute("BEGIN");  // one snapshot of all tables
  std::vector<StoredRun> runs = with_details(run_headers(filter));
  database_.execute("COMMIT");
  return runs;
}

std::vector<StoredPlan> Store::plans() const {
  std::vector<StoredPlan> plans;
  Statement rows = database_.prepare("SELECT name, title, text FROM plan ORDER BY name");
  while (rows.step()) {
    plans.push_back({rows.text(0), rows.text(1), rows.text(2), {}});
    Statement entries = database_.prepare("SELECT run_key FROM plan_entry WHERE plan = ? ORDER BY position");
    entries.bind(plans.back().name);
    while (entries.step()) plans.back().run_keys.push_back(entries.text(0));
  }
  return plans;
}

std::vector<StoredRun> Store::plan_runs(const std::string& plan) const {
  std::string known;
  for (const StoredPlan& stored : plans()) {
    known += (known.empty() ? "" : ", ") + stored.name;
    if (stored.name != plan) continue;
    std::unordered_map<std::string, StoredRun> by_key;
    for (StoredRun& run : runs()) by_key[run.key] = std::move(run);
    std::vector<StoredRun> ordered;
    for (const std::string& key : stored.run_keys) {
      if (const auto found = by_key.find(key); found != by_key.end()) ordered.push_back(found->second);
    }
    return ordered;
  }
  throw InputError(file().string(),
                   "contains no plan \"" + plan + "\"; it contains: " + (known.empty() ? "none" : known));
}

std::vector<Acceptance> Store::acceptances() const {
  std::vector<Acceptance> acceptances;
  if (database_.integer("SELECT count(*) FROM sqlite_master WHERE name = 'acceptance'") == 0)
    return acceptances;
  Statement rows = database_.prepare(
      "SELECT build, metric, variant, sequence, reason, accepted FROM acceptance "
      "ORDER BY build, metric, variant, sequence");
  while (rows.step()) {
    acceptances.push_back(
        {rows.text(0), rows.text(1), rows.text(2), rows.text(3), rows.text(4), rows.text(5)});
  }
  return acceptances;
}

std::int64_t Store::unfinished() const {
  return database_.integer("SELECT count(*) FROM run WHERE state = 'running'");
}

std::string Store::manifest(const StoredRun& run) const {
  Statement row = database_.prepare("SELECT json FROM manifest WHERE hash = ?");
  row.bind(run.manifest_hash);
  return row.step() ? row.text(0) : "";
}

std::string Store::attachment(const StoredRun& run, const std::string& kind) const {
  const auto found = run.blobs.find(kind);
  return found == run.blobs.end() ? "" : blobs_.get(found->second);
}

Trajectory Store::trajectory(const StoredRun& run) const { return poses(run, "trajectory"); }

Trajectory Store::truth(const StoredRun& run) const { return poses(run, "truth"); }

std::vector<FrameCounters> Store::frame_counters(const StoredRun& run) const {
  const std::string text = attachment(run, "counters");
  if (text.empty()) return {};
  return parse_counters(text, file().string() + ", run " + run.key);
}

Trajectory Store::poses(const StoredRun& run, const std::string& kind) const {
  const std::string text = attachment(run, kind);
  if (!has_rows(text)) return {.frame = "camera", .poses = {}};
  return eval::parse_tum(text, file().string() + ", run " + run.key, "camera").trajectory;
}

std::vector<TimingSample> Store::timing_samples(const StoredRun& run) const {
  const std::string text = attachment(run, "timings");
  if (text.empty()) return {};
  return parse_timings(text, file().string() + ", run " + run.key);
}

namespace {

Database existing_store(const fs::path& file) {
  static_cast<void>(Database(file, DatabaseAccess::kRead));  // throws if there is none
  Database database(file, DatabaseAccess::kWrite);
  migrate(database);
  return database;
}

bool is_readable(const Store& store, const StoredRun& run, const std::string& kind) {
  try {
    static_cast<void>(store.attachment(run, kind));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

void write_acceptances(const fs::path& file, const std::vector<Acceptance>& acceptances) {
  const Database database = existing_store(file);
  Transaction transaction(database);
  for (const Acceptance& acceptance : acceptances) {
    database
        .prepare(
            "INSERT OR REPLACE INTO acceptance (build, metric, variant, sequence, reason, accepted) "
            "VALUES (?, ?, ?, ?, ?, ?)")
        .bind(acceptance.commit)
        .bind(acceptance.metric)
        .bind(acceptance.variant)
        .bind(acceptance.sequence)
        .bind(acceptance.reason)
        .bind(acceptance.accepted)
        .step();
  }
  transaction.commit();
}

bool withdraw_acceptance(const fs::path& file, const Acceptance& acceptance) {
  const Database database = existing_store(file);
  Transaction transaction(database);
  database.prepare("DELETE FROM acceptance WHERE build = ? AND metric = ? AND variant = ? AND sequence = ?")
      .bind(acceptance.commit)
      .bind(acceptance.metric)
      .bind(acceptance.variant)
      .bind(acceptance.sequence)
      .step();
  const bool removed = database.integer("SELECT changes()") > 0;
  transaction.commit();
  return removed;
}

ReadableRuns without_unreadable_files(const Store& store, std::vector<StoredRun> runs) {
  ReadableRuns result;
  for (StoredRun& run : runs) {
    std::string kinds;
    std::erase_if(run.blobs, [&](const auto& blob) {
      if (is_readable(store, run, blob.first)) return false;
      kinds += (kinds.empty() ? "" : ", ") + blob.first;
      return true;
    });
    if (kinds.empty()) continue;
    const std::string gap = "missing or damaged files: " + kinds;
    run.detail += (run.detail.empty() ? "" : "; ") + gap;
    result.gaps.push_back("run " + run.key + " (" + run.identity.sequence + ", " + run.identity.variant +
                          "): " + gap);
  }
  result.runs = std::move(runs);
  return result;
}

}  // namespace stillpoint::bench
