// SPDX-License-Identifier: BSD-3-Clause
#include "bench/cli/analysis/import/imported_runs.h"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>

#include "bench/store/store.h"
#include "bench/store/store_writer.h"
#include "core/base/error.h"

namespace stillpoint::bench {
namespace {

constexpr std::string_view kRemedy =
    "pass another --store, or another name by --system (for a result of evo also by --sequence)";

bool is_same_subject(const RunIdentity& a, const RunIdentity& b) {
  return a.system == b.system && a.variant == b.variant && a.sequence_id == b.sequence_id &&
         a.repetition == b.repetition;
}

/// Whether a stored run of the same subject is the imported one.
/// @throws InputError if it has another outcome or another value of the same metric
bool is_equal(const StoredRun& stored, const ImportedRun& run, const std::filesystem::path& store) {
  const RunIdentity& id = run.identity;
  const bool is_same_key = stored.key == run_key(id);
  if (is_same_key && stored.outcome != run.outcome.outcome)
    throw InputError(store.string(), fmt::format("has run {} of {} on {} as {}, not {}; {}", id.repetition,
                                                 id.system, id.sequence, outcome_name(stored.outcome),
                                                 outcome_name(run.outcome.outcome), kRemedy));
  bool is_found = is_same_key;
  for (const Metric& metric : run.outcome.metrics) {
    const auto known = std::ranges::find(stored.metrics, metric.name, &Metric::name);
    if (known == stored.metrics.end()) continue;
    is_found = true;
    if (known->protocol == metric.protocol && known->value == metric.value) continue;
    throw InputError(store.string(),
                     fmt::format("has another {} of {} on {}: {:g} by \"{}\", not {:g} by \"{}\"; {}",
                                 metric.name, id.system, id.sequence, known->value, known->protocol,
                                 metric.value, metric.protocol, kRemedy));
  }
  return is_found;
}

/// The runs that a store does not have.
std::vector<const ImportedRun*> missing_runs(const std::filesystem::path& store,
                                             const std::vector<ImportedRun>& runs) {
  std::vector<StoredRun> related;
  if (std::filesystem::exists(store)) {
    const Store stored(store);
    related = stored.run_headers();
    std::erase_if(related, [&](const StoredRun& candidate) {
      return std::ranges::none_of(
          runs, [&](const ImportedRun& run) { return is_same_subject(candidate.identity, run.identity); });
    });
    related = stored.with_details(std::move(related));
  }
  std::vector<const ImportedRun*> missing;
  for (const ImportedRun& run : runs) {
    const bool is_present = std::ranges::any_of(related, [&](const StoredRun& candidate) {
      return is_same_subject(candidate.identity, run.identity) && is_equal(candidate, run, store);
    });
    if (!is_present) missing.push_back(&run);
  }
  return missing;
}

/// @throws InputError if two runs have one key
void require_distinct(const std::vector<ImportedRun>& runs) {
  std::set<std::string> keys;
  for (const ImportedRun& run : runs) {
    if (!keys.insert(run_key(run.identity)).second)
      throw InputError(fmt::format("run {} of {} on {}", run.identity.repetition, run.identity.variant,
                                   run.identity.sequence),
                       "is there twice; name each sequence and file once");
  }
}

}  // namespace

RunIdentity imported_identity() { return {.build = "imported", .mode = "external"}; }

MergeReport add_imported(const std::filesystem::path& store, const std::vector<ImportedRun>& runs) {
  require_distinct(runs);
  const std::vector<const ImportedRun*> missing = missing_runs(store, runs);
  MergeReport report{.added = missing.size(), .present = runs.size() - missing.size()};
  if (missing.empty()) return report;
  StoreWriter writer(store);
  for (const ImportedRun* const run : missing) {
    if (writer.acquire(run->identity) != RunLease::kGranted)
      throw InputError(store.string(), "is written by another process; try again");
    writer.finish(run->identity, run->outcome);
  }
  return report;
}

}  // namespace stillpoint::bench
