// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/store_writer.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <optional>

#include "bench/store/schema.h"
#include "core/base/error.h"
#include "core/base/system_resources.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannot_lock(const fs::path& file, int error) {
  require_resources(error, file.string());
  throw InputError(file.string(), std::string("cannot be locked: ") + std::strerror(error) +
                                      "; the folder of the store must be writable and on a local disk");
}

using std::chrono::nanoseconds;
using std::chrono::system_clock;

constexpr const char* kWorkersFolder = "workers";

/// Unique over time, too: process ids are reused. The second part is the time since the epoch [ns].
std::string new_name() {
  const auto now = system_clock::now().time_since_epoch();
  return std::to_string(getpid()) + "-" +
         std::to_string(std::chrono::duration_cast<nanoseconds>(now).count());
}

/// The time in a name; nullopt if it has none.
std::optional<system_clock::time_point> time_of(const std::string& name) {
  const std::size_t begin = name.find('-') + 1;
  std::int64_t ns = 0;
  const auto [end, error] = std::from_chars(name.data() + begin, name.data() + name.size(), ns);
  if (begin == 0 || error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  return system_clock::time_point(std::chrono::duration_cast<system_clock::duration>(nanoseconds(ns)));
}

bool is_locked(const fs::path& lock_file) {
  const int file = open(lock_file.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = flock(file, LOCK_SH | LOCK_NB) != 0;  // shared: other processes may test it, too
  close(file);
  return locked;
}

constexpr const char* kInsertRun =
    "INSERT INTO run (key, system, variant, sequence, sequence_id, config_hash, build, mode, kind, cores, "
    "seed, repetition, axis, axis_value, state, worker, started) "
    "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 'running', ?, ?)";

Database open_for_writing(const fs::path& file) {
  std::error_code ignored;  // opening the database reports the error
  if (file.has_parent_path()) fs::create_directories(file.parent_path(), ignored);
  Database database(file, DatabaseAccess::kWrite);
  migrate(database);
  Statement check = database.prepare("PRAGMA quick_check(1)");
  if (!check.step() || check.text(0) != "ok") {
    std::string fault = check.text(0);
    std::ranges::replace(fault, '\n', ' ');
    throw InputError(file.string(), "is damaged (" + fault +
                                        "); save what is readable with `stillpoint store salvage STORE OUT`, "
                                        "and continue with OUT");
  }
  return database;
}

}  // namespace

WorkerLock::WorkerLock(fs::path folder) : workers_(std::move(folder)), name_(new_name()) {
  // The file is locked under a temporary name and renamed afterwards, so that no other worker finds it
  // unlocked and takes this one for dead.
  const fs::path file = workers_ / (name_ + ".lock");
  const fs::path pending = workers_ / (name_ + ".new");
  std::error_code error;
  fs::create_directories(workers_ / name_, error);
  if (error) cannot_lock(workers_ / name_, error.value());
  lock_ = open(pending.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0 || flock(lock_, LOCK_EX | LOCK_NB) != 0) cannot_lock(pending, errno);
  fs::rename(pending, file);
}

WorkerLock::~WorkerLock() {
  std::error_code ignored;
  fs::remove_all(folder(), ignored);
  fs::remove(workers_ / (name_ + ".lock"), ignored);
  close(lock_);
}

bool WorkerLock::is_alive(const std::string& name) const {
  return name == name_ || is_locked(workers_ / (name + ".lock"));
}

void WorkerLock::remove_stale() const {
  std::vector<std::string> dead;
  for (const fs::directory_entry& entry : fs::directory_iterator(workers_)) {
    if (entry.path().extension() == ".lock" && !is_alive(entry.path().stem().string())) {
      dead.push_back(entry.path().stem().string());
    }
  }
  std::error_code ignored;  // another worker may be removing the same files
  for (const std::string& name : dead) {
    fs::remove_all(workers_ / name, ignored);
    fs::remove(workers_ / (name + ".lock"), ignored);
  }
}

std::vector<LiveWorker> live_workers(const fs::path& store_file) {
  std::vector<LiveWorker> workers;
  std::error_code error;  // no folder: there was never a worker
  for (const fs::directory_entry& entry :
       fs::directory_iterator(files_folder(store_file) / kWorkersFolder, error)) {
    const std::string name = entry.path().stem().string();
    const auto since = time_of(name);
    if (entry.path().extension() == ".lock" && since && is_locked(entry.path()))
      workers.push_back({name, *since});
  }
  return workers;
}

StoreWriter::StoreWriter(const fs::path& file)
    : database_(open_for_writing(file)),
      blobs_(files_folder(file) / "blobs"),
      worker_(files_folder(file) / kWorkersFolder) {
  worker_.remove_stale();
}

void StoreWriter::record_plan(const StoredPlan& plan) {
  Transaction transaction(database_);
  database_.prepare("DELETE FROM plan WHERE name = ?").bind(plan.name).step();
  database_.prepare("INSERT INTO plan (name, title, text) VALUES (?, ?, ?)")
      .bind(plan.name)
      .bind(plan.title)
      .bind(plan.text)
      .step();
  for (std::size_t i = 0; i < plan.run_keys.size(); ++i) {
    database_.prepare("INSERT INTO plan_entry (plan, position, run_key) VALUES (?, ?, ?)")
        .bind(plan.name)
        .bind(static_cast<std::int64_t>(i))
        .bind(plan.run_keys[i])
        .step();
  }
  transaction.commit();
}

RunLease StoreWriter::acquire(const RunIdentity& identity) {
  const std::string key = run_key(identity);
  Transaction transaction(database_);
  Statement existing = database_.prepare("SELECT state, worker FROM run WHERE key = ?");
  existing.bind(key);
  if (existing.step()) {
    if (existing.text(0) == "ended") return RunLease::kDone;
    if (worker_.is_alive(existing.text(1))) return RunLease::kLeasedByOther;
    database_.prepare("DELETE FROM run WHERE key = ?").bind(key).step();
  }
  database_.prepare(kInsertRun)
      .bind(key)
      .bind(identity.system)
      .bind(identity.variant)
      .bind(identity.sequence)
      .bind(identity.sequence_id)
      .bind(identity.config_hash)
      .bind(identity.build)
      .bind(identity.mode)
      .bind(identity.kind)
      .bind(identity.cores)
      .bind(identity.seed)
      .bind(identity.repetition)
      .bind(identity.axis)
      .bind(identity.axis_value)
      .bind(worker_.name())
      .bind(utc_now())
      .step();
  transaction.commit();
  return RunLease::kGranted;
}

void StoreWriter::write_files(const RunOutcome& outcome) const {
  for (const auto& [kind, content] : outcome.attachments) static_cast<void>(blobs_.put(content));
}

void StoreWriter::finish(const RunIdentity& identity, const RunOutcome& outcome) {
  const std::string key = run_key(identity);
  Transaction transaction(database_);  // also blocks collect_garbage() until the row references the files
  Statement row = database_.prepare("SELECT id FROM run WHERE key = ? AND state = 'running' AND worker = ?");
  row.bind(key).bind(worker_.name());
  STILLPOINT_CHECK(row.step());
  const std::int64_t id = row.integer(0);
  write_details(id, outcome);
  database_
      .prepare(
          "UPDATE run SET state = 'ended', started = coalesce(nullif(?, ''), started), ended = ?, "
          "outcome = ?, detail = ? WHERE id = ?")
      .bind(outcome.started)
      .bind(outcome.ended.empty() ? utc_now() : outcome.ended)
      .bind(outcome_name(outcome.outcome))
      .bind(outcome.detail)
      .bind(id)
      .step();
  transaction.commit();
}

void StoreWriter::write_details(std::int64_t run, const RunOutcome& outcome) {
  for (const Metric& metric : outcome.metrics) {
    database_.prepare("INSERT INTO metric (run, name, protocol, unit, value) VALUES (?, ?, ?, ?, ?)")
        .bind(run)
        .bind(metric.name)
        .bind(metric.protocol)
        .bind(metric.unit)
        .bind(metric.value)
        .step();
  }
  for (const ModuleCost& cost : outcome.costs) {
    database_
        .prepare(
            "INSERT INTO timing (run, module, per, calls, mean_ms, median_ms, p95_ms, max_ms) "
            "VALUES (?, ?, ?, ?, ?, ?, ?, ?)")
        .bind(run)
        .bind(cost.module)
        .bind(cost.per)
        .bind(cost.calls)
        .bind(cost.mean_ms)
        .bind(cost.median_ms)
        .bind(cost.p95_ms)
        .bind(cost.max_ms)
        .step();
  }
  for (const auto& [kind, content] : outcome.attachments) {
    database_.prepare("INSERT INTO attachment (run, kind, blob) VALUES (?, ?, ?)")
        .bind(run)
        .bind(kind)
        .bind(blobs_.put(content))
        .step();
  }
  if (outcome.manifest.empty()) return;
  const std::string hash = blob_name(outcome.manifest);
  database_.prepare("INSERT OR IGNORE INTO manifest (hash, json) VALUES (?, ?)")
      .bind(hash)
      .bind(outcome.manifest)
      .step();
  database_.prepare("UPDATE run SET manifest = ? WHERE id = ?").bind(hash).bind(run).step();
}

void StoreWriter::release(const RunIdentity& identity) {
  database_.prepare("DELETE FROM run WHERE key = ? AND state = 'running' AND worker = ?")
      .bind(run_key(identity))
      .bind(worker_.name())
      .step();
}

void StoreWriter::remove_runs(const std::vector<std::string>& keys, const std::vector<Outcome>& outcomes) {
  Transaction transaction(database_);
  for (const std::string& key : keys) {
    for (const Outcome outcome : outcomes) {
      database_.prepare("DELETE FROM run WHERE key = ? AND outcome = ?")
          .bind(key)
          .bind(outcome_name(outcome))
          .step();
    }
  }
  transaction.commit();
}

bool StoreWriter::is_done(const std::string& key) const {
  Statement row = database_.prepare("SELECT 1 FROM run WHERE key = ? AND state = 'ended'");
  return row.bind(key).step();
}

fs::path StoreWriter::work_folder(const RunIdentity& identity) const {
  fs::path folder = worker_.folder() / run_key(identity);
  fs::create_directories(folder);
  return folder;
}

}  // namespace stillpoint::bench
