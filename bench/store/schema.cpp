// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/schema.h"

#include <array>
#include <string_view>

#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

/// Migration step i leads from version i to i + 1. Published steps are never changed, so the older ones use
/// the names of their time.
constexpr std::array<const char*, 3> kSteps = {R"sql(
-- What does not differ from run to run, or seldom: configs, machines, builds.
CREATE TABLE manifest (
  hash TEXT PRIMARY KEY,
  json TEXT NOT NULL
) WITHOUT ROWID;

-- The journal: a row is written before a run starts ('running') and completed when it has ended.
CREATE TABLE run (
  id INTEGER PRIMARY KEY,
  key TEXT NOT NULL UNIQUE,       -- hash of everything below that makes two runs the same run
  system TEXT NOT NULL,
  variant TEXT NOT NULL,
  sequence TEXT NOT NULL,
  sequence_id TEXT NOT NULL,      -- checksum of its files, or the key of a rendering
  config_hash TEXT NOT NULL,
  build TEXT NOT NULL,            -- git commit, "+" and a hash of the changes when there are any
  mode TEXT NOT NULL,
  kind TEXT NOT NULL,             -- accuracy or timing
  cores TEXT NOT NULL,
  seed INTEGER NOT NULL,
  repetition INTEGER NOT NULL,
  axis TEXT NOT NULL,             -- key of a sweep; empty outside one
  axis_value REAL NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('running', 'ended')),
  driver TEXT NOT NULL,           -- who makes or made it
  started TEXT NOT NULL,          -- UTC
  ended TEXT,
  outcome TEXT CHECK (outcome IN ('ok', 'lost', 'crashed', 'timed_out', 'out_of_memory', 'bad_data')),
  detail TEXT,                    -- why it is not ok
  manifest TEXT REFERENCES manifest(hash),
  CHECK ((state = 'ended') = (outcome IS NOT NULL))
);
CREATE INDEX run_by_subject ON run(sequence, variant, seed, repetition);

CREATE TABLE metric (
  run INTEGER NOT NULL REFERENCES run(id) ON DELETE CASCADE,
  name TEXT NOT NULL,
  recipe TEXT NOT NULL,           -- how the number was made
  unit TEXT NOT NULL,
  value REAL NOT NULL,            -- a number without data has no row
  PRIMARY KEY (run, name, recipe)
) WITHOUT ROWID;

CREATE TABLE timing (
  run INTEGER NOT NULL REFERENCES run(id) ON DELETE CASCADE,
  module TEXT NOT NULL,
  per TEXT NOT NULL CHECK (per IN ('call', 'frame')),
  calls INTEGER NOT NULL,
  mean_ms REAL NOT NULL,
  median_ms REAL NOT NULL,
  p95_ms REAL NOT NULL,
  max_ms REAL NOT NULL,
  PRIMARY KEY (run, module)
) WITHOUT ROWID;

CREATE TABLE attachment (
  run INTEGER NOT NULL REFERENCES run(id) ON DELETE CASCADE,
  kind TEXT NOT NULL,             -- trajectory, frames, timings, result, log
  blob TEXT NOT NULL,             -- name of the file beside the store
  PRIMARY KEY (run, kind)
) WITHOUT ROWID;

-- What was asked for, so that a table can be made again in its order.
CREATE TABLE plan (
  name TEXT PRIMARY KEY,
  title TEXT NOT NULL,
  text TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE plan_entry (
  plan TEXT NOT NULL REFERENCES plan(name) ON DELETE CASCADE,
  position INTEGER NOT NULL,
  run_key TEXT NOT NULL,          -- the run may not be made yet
  PRIMARY KEY (plan, position)
) WITHOUT ROWID;
)sql",
                                               R"sql(
-- Changes of numbers that people accept.
CREATE TABLE acceptance (
  build TEXT NOT NULL,            -- the commit that brought the change
  metric TEXT NOT NULL,           -- name of a metric or of a module
  variant TEXT NOT NULL,          -- empty: all
  sequence TEXT NOT NULL,         -- likewise
  reason TEXT NOT NULL,
  accepted TEXT NOT NULL,         -- UTC
  PRIMARY KEY (build, metric, variant, sequence)
) WITHOUT ROWID;
)sql",
                                               R"sql(
ALTER TABLE metric RENAME COLUMN recipe TO protocol;
ALTER TABLE run RENAME COLUMN driver TO worker;
UPDATE attachment SET kind = 'image:' || substr(kind, length('picture:') + 1) WHERE kind LIKE 'picture:%';
)sql"};

constexpr int kRenamedVersion = 3;  // the version whose step renames columns and attachments
constexpr std::string_view kOldImageKind = "picture:";

std::string version_text(std::int64_t version) { return std::to_string(version); }

/// @return its schema version; 0 for an empty file
std::int64_t version_of(const Database& database) {
  const std::int64_t version = database.integer("PRAGMA user_version");
  const bool empty = database.integer("SELECT count(*) FROM sqlite_master") == 0;
  if (!empty && database.integer("PRAGMA application_id") != kApplicationId) {
    throw InputError(database.file().string(),
                     "is another program's database; give the file of a store, or the name of a new one");
  }
  if (version > schema_version()) {
    throw InputError(database.file().string(), "was written by a newer version (schema " +
                                                   version_text(version) + ", this program supports " +
                                                   version_text(schema_version()) +
                                                   "); use that version, or give another --store");
  }
  return version;
}

}  // namespace

int schema_version() { return static_cast<int>(kSteps.size()); }

void migrate(const Database& database, int version) {
  if (version_of(database) >= version) return;
  database.execute_when_free("PRAGMA journal_mode = WAL");
  Transaction transaction(database);
  // Read again: another worker may have migrated the store while this one waited for the lock.
  for (std::int64_t step = version_of(database); step < version; ++step) {
    database.execute(kSteps[static_cast<std::size_t>(step)]);
    database.execute("PRAGMA user_version = " + version_text(step + 1));
  }
  database.execute("PRAGMA application_id = " + std::to_string(kApplicationId));
  transaction.commit();
}

void require_readable_schema(const Database& database) {
  if (version_of(database) > 0) return;
  throw InputError(database.file().string(), "is empty; fill it with `stillpoint bench PLAN --store FILE`");
}

std::string protocol_column(const Database& database) {
  return version_of(database) < kRenamedVersion ? kOldProtocolName : "protocol";
}

std::string current_kind(const std::string& kind) {
  if (!kind.starts_with(kOldImageKind)) return kind;
  return std::string(kImageKind) + kind.substr(kOldImageKind.size());
}

StoredRun run_of(const Statement& row) {
  StoredRun run;
  run.id = row.integer(0);
  run.key = row.text(1);
  run.identity = {.system = row.text(2),
                  .variant = row.text(3),
                  .sequence = row.text(4),
                  .sequence_id = row.text(5),
                  .config_hash = row.text(6),
                  .build = row.text(7),
                  .mode = row.text(8),
                  .kind = row.text(9),
                  .cores = row.text(10),
                  .seed = row.integer(11),
                  .repetition = row.integer(12),
                  .axis = row.text(13),
                  .axis_value = row.real(14)};
  run.outcome = outcome_of(row.text(15));
  run.detail = escaped_utf8(row.text(16));
  run.started = row.text(17);
  run.ended = row.text(18);
  run.manifest_hash = row.text(19);
  return run;
}

Metric metric_of(const Statement& row) { return {row.text(1), row.text(2), row.text(3), row.real(4)}; }

ModuleCost cost_of(const Statement& row) {
  return {row.text(1), row.text(2), row.integer(3), row.real(4), row.real(5), row.real(6), row.real(7)};
}

}  // namespace stillpoint::bench
