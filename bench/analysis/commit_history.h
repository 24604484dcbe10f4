// SPDX-License-Identifier: BSD-3-Clause
/// History of all metrics of a system over its commits or versions, as time series.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/model/metrics.h"
#include "bench/store/store.h"

namespace stillpoint::bench {

struct Commit {
  std::string name;  ///< git commit, with "+" and a hash of uncommitted changes if any; else the build name
  std::string time;  ///< UTC commit time; if not in the manifests, start of the first run
  std::string subject{};   ///< first line of its message; not in a store, empty if unknown
  std::string authored{};  ///< author date, UTC; same
  std::string link{};      ///< its page at a code host; same
};

/// What a value was measured on. Values of different machines, or of different data under the same name,
/// belong to different series.
struct HistorySubject {
  std::string sequence;
  std::string variant;
  std::string axis;  ///< swept parameter; empty outside a sweep
  double axis_value = 0.0;
  std::string mode;
  std::string kind;
  std::string cores;
  std::int64_t seed = 1;    ///< of a rendered scene, and of the odometry
  std::string sequence_id;  ///< identifies the data; the name alone is not unique
  std::string host;         ///< CPU model and count: "Intel(R) N100, 4 processors"

  auto operator<=>(const HistorySubject&) const = default;
};

/// One metric over commits: for each commit the median over its successful runs, including repetitions. Runs
/// without a finite value of a compared metric count as worse than any number.
struct HistorySeries {
  HistorySubject subject;
  std::vector<std::string> plans;  ///< current plans that contain it, for runs of any commit
  std::string metric;              ///< metric name, module name, or `metric_id::kFailedRuns`
  std::string unit;
  const MetricDescriptor* gated = nullptr;  ///< null: displayed, but not tested
  std::vector<std::size_t> commits;         ///< indices, ascending; commits without a value are omitted
  std::vector<double> values;               ///< at `commits`
  std::vector<std::size_t> runs;            ///< number of runs behind each value
};

struct CommitHistory {
  std::string system;           ///< this odometry or an external system
  std::vector<Commit> commits;  ///< by time, ties by the order of their first runs
  std::vector<HistorySeries> series;
};

/// The systems of the completed runs, in alphabetical order.
[[nodiscard]] std::vector<std::string> systems_of(const Store& store);

/// History of the runs of one system in a store; the commits of an external system are its versions, in the
/// order of their first runs. A run without a manifest (interrupted) is assigned to the machine of the
/// previous run.
/// @param store of all systems
/// @param system name; empty: this odometry, or the only one in a store without it
/// @throws InputError if a name is given of which the store has no run
[[nodiscard]] CommitHistory commit_history(const Store& store, const std::string& system = "");

/// Index of the commit with a name or unique name prefix.
/// @throws InputError if there is none, or more than one
[[nodiscard]] std::size_t find_commit(const CommitHistory& history, const std::string& name);

}  // namespace stillpoint::bench
