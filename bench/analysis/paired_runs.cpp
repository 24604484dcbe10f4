// SPDX-License-Identifier: BSD-3-Clause
#include "bench/analysis/paired_runs.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "bench/analysis/run_groups.h"
#include "bench/model/metrics.h"
#include "bench/model/stored_run.h"

namespace stillpoint::bench {
namespace {

using Runs = std::vector<const StoredRun*>;

/// Equal for runs that may be paired.
std::string pair_key(RunIdentity identity) {
  identity.build.clear();
  identity.config_hash.erase(0, unperturbed_hash(identity.config_hash).size());
  return run_key(identity);
}

/// Removes and returns the counterpart of a run; null if there is none.
/// @param is_only whether the run is the only one of its side with this key
const StoredRun* take_counterpart(const StoredRun& run, Runs& candidates, bool is_only) {
  auto found = std::find_if(candidates.begin(), candidates.end(), [&](const StoredRun* candidate) {
    return candidate->identity.config_hash == run.identity.config_hash;
  });
  if (found == candidates.end() && is_only && candidates.size() == 1) found = candidates.begin();
  if (found == candidates.end()) return nullptr;
  const StoredRun* counterpart = *found;
  candidates.erase(found);
  return counterpart;
}

}  // namespace

PairedRuns paired_runs(std::span<const StoredRun> base, std::span<const StoredRun> head) {
  std::map<std::string, Runs> candidates;
  for (const StoredRun& run : head) candidates[pair_key(run.identity)].push_back(&run);
  std::map<std::string, std::size_t> base_count;
  for (const StoredRun& run : base) ++base_count[pair_key(run.identity)];
  PairedRuns paired;
  for (const StoredRun& run : base) {
    const std::string key = pair_key(run.identity);
    const StoredRun* counterpart = take_counterpart(run, candidates[key], base_count[key] == 1);
    if (counterpart != nullptr) {
      paired.pairs.push_back({&run, counterpart});
    } else {
      paired.only_in_base.push_back(&run);
    }
  }
  for (const StoredRun& run : head) {
    const Runs& left = candidates[pair_key(run.identity)];
    if (std::find(left.begin(), left.end(), &run) != left.end()) paired.only_in_head.push_back(&run);
  }
  return paired;
}

bool both_succeeded(const RunPair& pair) {
  return pair.base->outcome == Outcome::kOk && pair.head->outcome == Outcome::kOk;
}

bool is_bit_equal(const RunPair& pair) {
  const auto base = pair.base->blobs.find("trajectory");
  const auto head = pair.head->blobs.find("trajectory");
  return base != pair.base->blobs.end() && head != pair.head->blobs.end() && base->second == head->second;
}

bool repeats_by_design(const RunIdentity& identity) {
  return identity.system == kOwnSystem && !identity.mode.ends_with("realtime");
}

std::string input_key(const RunIdentity& identity) {
  RunIdentity any = identity;
  any.build.clear();
  any.config_hash.clear();
  any.repetition = 1;
  if (any.axis == kPerturbationKey) {
    any.axis.clear();
    any.axis_value = 0.0;
  }
  return run_key(any);
}

std::string fingerprint(const StoredRun& run) {
  // Equal trajectories on other data, e.g. of a system that does not move, are other results.
  std::string text = run.identity.sequence_id + " ";
  const auto trajectory = run.blobs.find("trajectory");
  if (trajectory != run.blobs.end()) return text + trajectory->second;
  bool is_specific = false;  // different runs may have the same rates
  for (const Metric& metric : run.metrics) {
    const MetricDescriptor* descriptor = gated_metric(metric.name);
    if (descriptor == nullptr || descriptor->gate->family != MetricFamily::kAccuracy) continue;
    text += fmt::format("{}={} ", metric.name, metric.value);
    is_specific = is_specific || (metric.name == metric_id::kAte && metric.value != 0.0);
  }
  return is_specific ? text : "";
}

}  // namespace stillpoint::bench
