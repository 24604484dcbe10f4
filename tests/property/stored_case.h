// SPDX-License-Identifier: BSD-3-Clause
/// Random stores with planted effects as files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "bench/store/store_writer.h"
#include "tests/property/planted_store.h"

namespace stillpoint::bench {

inline std::string trajectory_text(const StoredRun& run) {
  return fmt::format("# {}\n0.0 0 0 0 0 0 0 1\n0.1 {} 0 0 0 0 0 1\n", run.key, run.metrics.front().value);
}

inline std::string manifest_text(const RunIdentity& identity) {
  return fmt::format(
      R"({{"config": {{"resolved": {{"variant": "{}", "seed": {}}}}},
          "build": {{"git_commit": "{}", "git_time": "2026-01-01T00:00:00Z"}},
          "host": {{"cpu": "CPU", "logical_cpus": 2}}}})",
      identity.variant, identity.seed, identity.build);
}

/// Writes the runs, and a plan "p" with the runs of the newest build, whose ablation has the base of the
/// store.
inline void write_store(const PlantedStore& store, const std::filesystem::path& file) {
  StoreWriter writer(file);
  StoredPlan plan{.name = "p", .title = "", .text = "", .run_keys = {}};
  plan.text = fmt::format("ablation_base = \"{}\"\nvariants = [\"{}\", \"{}\"]\n", store.base, store.base,
                          kChangedVariant);
  for (const StoredRun& run : store.runs) {
    RunOutcome outcome{.outcome = run.outcome, .detail = run.detail, .metrics = run.metrics};
    if (run.outcome == Outcome::kOk) {
      outcome.attachments = {{"trajectory", trajectory_text(run)}};
      outcome.manifest = manifest_text(run.identity);
    }
    static_cast<void>(writer.acquire(run.identity));
    writer.finish(run.identity, outcome);
    if (run.identity.build == store.builds.back()) plan.run_keys.push_back(run.key);
  }
  writer.record_plan(plan);
}

/// Removes the trajectory of the last successful run; false if no run succeeded.
inline bool remove_blob(const PlantedStore& store, const std::filesystem::path& file) {
  for (auto run = store.runs.rbegin(); run != store.runs.rend(); ++run) {
    if (run->outcome != Outcome::kOk) continue;
    return std::filesystem::remove(BlobFiles(files_folder(file)).file(blob_name(trajectory_text(*run))));
  }
  return false;
}

}  // namespace stillpoint::bench
