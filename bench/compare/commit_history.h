// SPDX-License-Identifier: BSD-3-Clause
/// Every number of our odometry over the commits that it was measured at, by what it was measured on.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/compare/metric_rules.h"
#include "bench/store/store.h"

namespace stillpoint {

/// Name of the series of how many runs did not end well, as a share.
inline constexpr const char* kFailedRuns = "failed_runs";

struct Commit {
  std::string name;  ///< git commit, "+" and a hash of the changes when there are any; else the build's name
  std::string
      time;  ///< UTC: when it was committed; where the manifests do not tell, when its first run began
};

/// What a number was measured on. Numbers of two machines, or of two data sets of one name, are never one
/// series.
struct HistorySubject {
  std::string sequence;
  std::string variant;
  std::string axis;  ///< of a sweep; empty outside one
  double axis_value = 0.0;
  std::string mode;
  std::string kind;
  std::string cores;
  std::int64_t seed = 1;    ///< of the scene, where it is rendered, and of the odometry
  std::string sequence_id;  ///< other data of the same name are another series
  std::string host;  ///< class of machines: model and number of processors, "Intel(R) N100, 4 processors"

  auto operator<=>(const HistorySubject&) const = default;
};

/// One number over commits: at each the median over its runs that ended well, of all repetitions.
struct HistorySeries {
  HistorySubject subject;
  std::vector<std::string> plans;  ///< that ask for it today, whatever the commit
  std::string metric;              ///< name of a metric or of a module, or `kFailedRuns`
  std::string unit;
  std::optional<MetricRule> rule;    ///< which direction is good, and what matters; none: only shown
  std::vector<std::size_t> commits;  ///< indices, ascending; a commit without a number is left out
  std::vector<double> values;        ///< at these commits
  std::vector<std::size_t> runs;     ///< behind each of them
};

struct CommitHistory {
  std::vector<Commit> commits;  ///< by time; of one time, in the order of their first runs
  std::vector<HistorySeries> series;
};

/// Runs of other systems are left out. A run without a manifest (it broke off) counts for the machine of the
/// run before it.
[[nodiscard]] CommitHistory commit_history(const Store& store);

/// The commit that a name or its beginning means.
/// @throws InputError if there is none, or more than one
[[nodiscard]] std::size_t find_commit(const CommitHistory& history, const std::string& name);

}  // namespace stillpoint
