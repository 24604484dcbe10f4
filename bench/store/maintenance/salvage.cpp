// SPDX-License-Identifier: BSD-3-Clause
#include "bench/store/maintenance/salvage.h"

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "bench/store/database.h"
#include "bench/store/maintenance/maintenance.h"
#include "bench/store/schema.h"
#include "bench/store/store.h"
#include "bench/store/store_writer.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPageBytes = 4096;  // of stores: SQLite's default
// Fields of the header with 4 bytes, big-endian (SQLite file format, section 1.3).
constexpr std::size_t kPageCountOffset = 28;
constexpr std::size_t kApplicationIdOffset = 68;

/// Whether a file has the header of a database of another program.
bool is_foreign(const fs::path& file) {
  constexpr std::string_view kMagic{"SQLite format 3\0", 16};
  std::string header(kApplicationIdOffset + 4, '\0');
  std::ifstream(file, std::ios::binary).read(header.data(), static_cast<std::streamsize>(header.size()));
  std::int64_t id = 0;
  for (std::size_t i = 0; i < 4; ++i)
    id = 256 * id + static_cast<unsigned char>(header[kApplicationIdOffset + i]);
  return header.starts_with(kMagic) && id != kApplicationId;
}

/// Whether the list of tables can be read.
bool has_tables(const fs::path& file) {
  try {
    const Database database(file, DatabaseAccess::kRead);
    static_cast<void>(database.prepare("SELECT 1 FROM run, metric, timing, attachment, manifest, plan"));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

/// First page of an empty store, with the number of pages of `file`.
std::string empty_first_page(const fs::path& folder, const fs::path& file) {
  const fs::path empty = folder / "empty.sqlite";
  {
    const Database database(empty, DatabaseAccess::kWrite);
    migrate(database);
    database.execute("PRAGMA wal_checkpoint(TRUNCATE)");
  }
  std::string page(kPageBytes, '\0');
  std::ifstream(empty, std::ios::binary).read(page.data(), static_cast<std::streamsize>(page.size()));
  std::uintmax_t pages = fs::file_size(file) / kPageBytes;
  for (std::size_t i = 4; i-- > 0; pages /= 256) page[kPageCountOffset + i] = static_cast<char>(pages % 256);
  return page;
}

void replace_first_page(const fs::path& file, const std::string& page) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.write(page.data(), static_cast<std::streamsize>(page.size()));
  if (!stream.flush()) throw InputError(file.string(), "cannot be written; check for a full disk");
}

void copy_to(const fs::path& from, const fs::path& to) {
  std::error_code error;
  if (!fs::copy_file(from, to, error))
    throw InputError(from.string(), "cannot be copied to " + to.string() + ": " + error.message());
}

/// "a DESC, b DESC" of {"a", "b"} with the direction " DESC".
std::string order_text(const std::vector<std::string>& columns, const char* direction) {
  std::string text;
  for (const std::string& column : columns) text += (text.empty() ? "" : ", ") + column + direction;
  return text;
}

/// A private copy of a damaged store; the store itself is only read as a file.
class DamagedDatabase {
 public:
  /// Copies the file and its write-ahead log. If the first page is damaged, which contains the list of
  /// tables, it is replaced by that of an empty store: the tables of stores have the same root pages unless
  /// the store was migrated from an older schema.
  /// @param folder for the copy; must not exist, removed by the destructor
  /// @throws InputError if the file cannot be copied, or is not a store
  DamagedDatabase(const fs::path& store, fs::path folder);
  ~DamagedDatabase();
  DamagedDatabase(const DamagedDatabase&) = delete;
  DamagedDatabase& operator=(const DamagedDatabase&) = delete;

  [[nodiscard]] const Database& database() const { return *database_; }
  [[nodiscard]] bool has_replaced_header() const { return replaced_header_; }

  /// Calls `use(row)` for each readable row of a query: in ascending order of the columns `order` up to the
  /// first damaged page, and then in descending order down to the last one.
  /// @param query without ORDER BY; an index must contain the rows in this order
  /// @return whether all rows were readable
  template <class Use>
  bool for_each_row(const std::string& query, const std::vector<std::string>& order, const Use& use) const {
    for (const char* direction : {"", " DESC"}) {
      try {
        Statement rows = database_->prepare(query + " ORDER BY " + order_text(order, direction));
        while (rows.step()) use(rows);
        return *direction == '\0';
      } catch (const InputError&) {
        continue;  // a damaged page; the rows behind it are read from the other end
      }
    }
    return false;
  }

 private:
  fs::path folder_;
  std::unique_ptr<Database> database_;
  bool replaced_header_ = false;
};

DamagedDatabase::DamagedDatabase(const fs::path& store, fs::path folder) : folder_(std::move(folder)) {
  if (!fs::is_regular_file(store)) throw InputError(store.string(), "there is no such store");
  std::error_code error;
  if (!fs::create_directories(folder_, error))
    throw InputError(folder_.string(), "cannot be created; remove it or choose another output");
  if (fs::space(folder_, error).available < fs::file_size(store) && !error) {
    fs::remove_all(folder_, error);
    throw InputError(store.string(), "is larger than the free space at " + folder_.string() +
                                         ", where a copy of it is repaired; choose another output");
  }
  const fs::path copy = folder_ / "store.sqlite";
  const fs::path log = store.string() + "-wal";
  try {
    copy_to(store, copy);
    if (fs::exists(log)) copy_to(log, copy.string() + "-wal");
    replaced_header_ = !is_foreign(copy) && !has_tables(copy);
    if (replaced_header_) replace_first_page(copy, empty_first_page(folder_, copy));
    if (replaced_header_ && !has_tables(copy))
      throw InputError(store.string(),
                       "contains nothing that can be read; it is no store, or completely damaged");
    database_ = std::make_unique<Database>(copy, DatabaseAccess::kRead);
    require_readable_schema(*database_);
  } catch (...) {
    database_.reset();
    fs::remove_all(folder_, error);
    throw;
  }
}

DamagedDatabase::~DamagedDatabase() {
  database_.reset();
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

/// Reads a damaged store, counts the rows and notes what is lost.
class Salvage {
 public:
  Salvage(const DamagedDatabase& source, const fs::path& store)
      : source_(source),
        blobs_(files_folder(store) / "blobs"),
        protocol_(protocol_column(source.database())) {
    if (source.has_replaced_header())
      report_.losses.emplace_back("the list of tables is damaged: assumed the tables of a new store");
  }

  [[nodiscard]] std::set<std::int64_t> run_ids();
  void copy_run(std::int64_t id, StoreWriter& target);
  [[nodiscard]] std::vector<StoredPlan> plans();
  [[nodiscard]] std::vector<Acceptance> acceptances();
  [[nodiscard]] const SalvageReport& report() const { return report_; }

 private:
  [[nodiscard]] std::optional<StoredRun> run_at(std::int64_t id);
  [[nodiscard]] RunOutcome outcome_of_run(const StoredRun& run);
  [[nodiscard]] std::vector<Metric> metrics_of(const StoredRun& run);
  [[nodiscard]] std::vector<ModuleCost> costs_of(const StoredRun& run);
  [[nodiscard]] std::map<std::string, std::string> blobs_of(const StoredRun& run);
  [[nodiscard]] std::string manifest_of(const StoredRun& run);
  [[nodiscard]] std::string name_of(std::int64_t id) const;

  const DamagedDatabase& source_;
  BlobFiles blobs_;
  std::string protocol_;
  std::map<std::int64_t, std::string> keys_;  ///< from the index of table run
  SalvageReport report_;
};

std::string of_run(std::int64_t id) { return " WHERE run = " + std::to_string(id); }

/// The identifiers in all tables and indices that mention runs, so that lost rows are noticed.
std::set<std::int64_t> Salvage::run_ids() {
  std::set<std::int64_t> ids;
  const auto add = [&](const Statement& row) { ids.insert(row.integer(0)); };
  source_.for_each_row("SELECT id FROM run NOT INDEXED", {"id"}, add);
  source_.for_each_row("SELECT id FROM run INDEXED BY run_by_subject",
                       {"sequence", "variant", "seed", "repetition"}, add);
  source_.for_each_row("SELECT id, key FROM run INDEXED BY sqlite_autoindex_run_1", {"key"},
                       [&](const Statement& row) {
                         add(row);
                         keys_[row.integer(0)] = row.text(1);
                       });
  source_.for_each_row("SELECT run FROM metric", {"run", "name", protocol_}, add);
  source_.for_each_row("SELECT run FROM timing", {"run", "module"}, add);
  source_.for_each_row("SELECT run FROM attachment", {"run", "kind"}, add);
  return ids;
}

std::string Salvage::name_of(std::int64_t id) const {
  const auto key = keys_.find(id);
  return "run " + (key == keys_.end() ? "number " + std::to_string(id) : key->second);
}

/// Nothing for a run that is not completed, or whose row is lost. The key is a hash of the identity, so that
/// it reveals altered rows.
std::optional<StoredRun> Salvage::run_at(std::int64_t id) {
  try {
    Statement row =
        source_.database().prepare(std::string("SELECT ") + kRunColumns +
                                   ", state FROM run NOT INDEXED WHERE id = " + std::to_string(id));
    if (row.step()) {
      if (row.text(20) == "running") return std::nullopt;
      StoredRun run = run_of(row);
      if (run.key == run_key(run.identity)) return run;
    }
  } catch (const InputError&) {
    // a damaged page, or a row with impossible values
  }
  report_.losses.push_back(name_of(id) + " is lost");
  return std::nullopt;
}

bool is_valid(const Metric& metric) { return !metric.name.empty() && !std::isnan(metric.value); }

bool is_valid(const ModuleCost& cost) {
  const bool is_number = std::isfinite(cost.mean_ms) && std::isfinite(cost.median_ms) &&
                         std::isfinite(cost.p95_ms) && std::isfinite(cost.max_ms);
  return is_number && (cost.per == "call" || cost.per == "frame");
}

std::vector<Metric> Salvage::metrics_of(const StoredRun& run) {
  std::map<std::pair<std::string, std::string>, Metric> metrics;
  const bool complete =
      source_.for_each_row("SELECT run, name, " + protocol_ + ", unit, value FROM metric" + of_run(run.id),
                           {"name", protocol_}, [&](const Statement& row) {
                             metrics[{row.text(1), row.text(2)}] = metric_of(row);
                           });
  const bool valid = std::erase_if(metrics, [](const auto& entry) { return !is_valid(entry.second); }) == 0;
  if (!complete || !valid) report_.losses.push_back(name_of(run.id) + ": metrics are lost");
  report_.saved["metric"] += metrics.size();
  std::vector<Metric> list;
  list.reserve(metrics.size());
  for (const auto& [name, metric] : metrics) list.push_back(metric);
  return list;
}

std::vector<ModuleCost> Salvage::costs_of(const StoredRun& run) {
  std::map<std::string, ModuleCost> costs;
  const bool complete =
      source_.for_each_row(std::string("SELECT ") + kCostColumns + " FROM timing" + of_run(run.id),
                           {"module"}, [&](const Statement& row) { costs[row.text(1)] = cost_of(row); });
  const bool valid = std::erase_if(costs, [](const auto& entry) { return !is_valid(entry.second); }) == 0;
  if (!complete || !valid) report_.losses.push_back(name_of(run.id) + ": times of modules are lost");
  report_.saved["timing"] += costs.size();
  std::vector<ModuleCost> list;
  list.reserve(costs.size());
  for (const auto& [module, cost] : costs) list.push_back(cost);
  return list;
}

std::map<std::string, std::string> Salvage::blobs_of(const StoredRun& run) {
  std::map<std::string, std::string> names;
  const bool complete =
      source_.for_each_row("SELECT kind, blob FROM attachment" + of_run(run.id), {"kind"},
                           [&](const Statement& row) { names[current_kind(row.text(0))] = row.text(1); });
  if (!complete) report_.losses.push_back(name_of(run.id) + ": names of files are lost");
  std::map<std::string, std::string> contents;
  for (const auto& [kind, name] : names) {
    try {
      contents[kind] = blobs_.get(name);
      ++report_.saved["file"];
    } catch (const InputError&) {
      report_.losses.push_back(
          fmt::format("{}: file {} ({}) is missing or damaged", name_of(run.id), kind, name));
    }
  }
  return contents;
}

std::string Salvage::manifest_of(const StoredRun& run) {
  if (run.manifest_hash.empty()) return "";
  try {
    Statement row = source_.database().prepare("SELECT json FROM manifest WHERE hash = ?");
    row.bind(run.manifest_hash);
    if (row.step() && blob_name(row.text(0)) == run.manifest_hash) return row.text(0);
  } catch (const InputError&) {
    // a damaged page
  }
  report_.losses.push_back(name_of(run.id) + ": manifest is lost");
  return "";
}

RunOutcome Salvage::outcome_of_run(const StoredRun& run) {
  RunOutcome outcome{.outcome = run.outcome, .detail = run.detail};
  const std::size_t losses = report_.losses.size();
  outcome.metrics = metrics_of(run);
  outcome.costs = costs_of(run);
  outcome.attachments = blobs_of(run);
  outcome.manifest = manifest_of(run);
  outcome.started = run.started;
  outcome.ended = run.ended;
  if (report_.losses.size() > losses)
    outcome.detail += (outcome.detail.empty() ? "" : "; ") + std::string("salvaged, not complete");
  return outcome;
}

void Salvage::copy_run(std::int64_t id, StoreWriter& target) {
  const std::optional<StoredRun> run = run_at(id);
  if (!run) return;
  keys_[id] = run->key;
  if (add_run(target, run->identity, outcome_of_run(*run))) ++report_.saved["run"];
}

std::vector<StoredPlan> Salvage::plans() {
  std::map<std::string, StoredPlan> plans;
  const bool all_plans =
      source_.for_each_row("SELECT name, title, text FROM plan", {"name"}, [&](const Statement& row) {
        plans[row.text(0)] = {row.text(0), row.text(1), row.text(2), {}};
      });
  std::map<std::string, std::map<std::int64_t, std::string>> entries;
  const bool all_entries =
      source_.for_each_row("SELECT plan, position, run_key FROM plan_entry", {"plan", "position"},
                           [&](const Statement& row) { entries[row.text(0)][row.integer(1)] = row.text(2); });
  if (!all_plans) report_.losses.emplace_back("plans are lost");
  if (!all_entries) report_.losses.emplace_back("keys of the runs of plans are lost");
  std::vector<StoredPlan> list;
  for (auto& [name, plan] : plans) {
    for (const auto& [position, key] : entries[name]) plan.run_keys.push_back(key);
    list.push_back(plan);
  }
  report_.saved["plan"] = list.size();
  return list;
}

std::vector<Acceptance> Salvage::acceptances() {
  std::vector<Acceptance> list;
  const bool has_table =
      source_.database().integer("SELECT count(*) FROM sqlite_master WHERE name = 'acceptance'") > 0;
  // The type is checked as the root page is only assumed if the list of tables is lost.
  const bool complete =
      !has_table ||
      source_.for_each_row(
          "SELECT build, metric, variant, sequence, reason, accepted FROM acceptance WHERE typeof(build) = "
          "'text'",
          {"build", "metric", "variant", "sequence"}, [&](const Statement& row) {
            list.push_back({row.text(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5)});
          });
  if (!complete) report_.losses.emplace_back("acceptances are lost");
  report_.saved["acceptance"] = list.size();
  return list;
}

}  // namespace

SalvageReport salvage_store(const fs::path& from, const fs::path& into) {
  if (fs::exists(into)) throw InputError(into.string(), "already exists; choose a new name");
  const DamagedDatabase source(from, into.string() + ".salvage-" + std::to_string(getpid()));
  Salvage salvage(source, from);
  const std::set<std::int64_t> ids = salvage.run_ids();
  const std::vector<StoredPlan> plans = salvage.plans();
  if (ids.empty() && plans.empty())
    throw InputError(from.string(),
                     "contains nothing that can be read; it is no store, or completely damaged");
  {
    StoreWriter target(into);
    for (const std::int64_t id : ids) salvage.copy_run(id, target);
    for (const StoredPlan& plan : plans) target.record_plan(plan);
  }
  write_acceptances(into, salvage.acceptances());
  return salvage.report();
}

}  // namespace stillpoint::bench
