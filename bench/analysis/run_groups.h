// SPDX-License-Identifier: BSD-3-Clause
/// Groups of runs that may be pooled in one statistic, and where a run comes from, by its manifest: commit,
/// machine and config.
#pragma once

#include <compare>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint::bench {

/// `RunIdentity::system` of this odometry.
inline constexpr const char* kOwnSystem = "stillpoint";

/// Where a run comes from.
struct RunOrigin {
  std::string commit;  ///< git commit, with "+" and a hash of uncommitted changes if any; else the build name
  std::string time;    ///< UTC commit time; empty if not in the manifest
  std::string host;    ///< CPU model and count: "Intel(R) N100, 4 processors"
  /// Identifies the config without its seeds, so that it is equal for replicates. Empty if unknown.
  std::string config;

  auto operator<=>(const RunOrigin&) const = default;
};

/// The origins of runs, by their index. Few of them differ, and each is stored once.
class RunOrigins {
 public:
  RunOrigins() = default;
  RunOrigins(RunOrigins&&) = default;  // a copy would refer to the elements of the other one
  RunOrigins& operator=(RunOrigins&&) = default;

  void push_back(const RunOrigin& origin) { runs_.push_back(&*distinct_.insert(origin).first); }
  [[nodiscard]] const RunOrigin& operator[](std::size_t run) const { return *runs_[run]; }

 private:
  std::set<RunOrigin> distinct_;
  std::vector<const RunOrigin*> runs_;
};

/// Origins of the runs of a store. A run without a manifest (interrupted) is assigned to the machine of the
/// previous run, and to the config of the runs with the same config hash.
/// @param runs in the order of their start
/// @return one element per run
[[nodiscard]] RunOrigins run_origins(const Store& store, std::span<const StoredRun> runs);

/// Runs of one build on one machine in one mode. Each variant has one config at each point of a sweep, up to
/// its seeds.
struct RunGroup {
  std::string build;
  std::string machine;  ///< CPU model and count
  std::string mode;     ///< mode, kind and processors: "sequential, timing, cores 0,1"
  std::vector<StoredRun> runs;
};

/// The groups of selected runs.
struct RunSelection {
  std::vector<RunGroup> groups;       ///< in the order of their first runs
  std::vector<std::string> left_out;  ///< sentences about the runs that are in no group
};

/// Key that is equal for runs of the same plan entry with different builds: excludes the build, and the
/// config hash, since defaults may change with the build.
[[nodiscard]] std::string planned_key(RunIdentity identity);

/// Headers of the runs of a plan with the build that executed it last, and those of the same plan entries
/// with other builds, in the order of their start.
/// @throws InputError if the store does not contain the plan; the message lists those that it contains
[[nodiscard]] std::vector<StoredRun> runs_of_plan(const Store& store, const std::string& plan);

/// The build of this odometry, or without its runs that of any system, with the latest commit time, or the
/// latest first run where manifests lack it; empty without runs.
[[nodiscard]] std::string newest_build(std::span<const StoredRun> runs);

/// The newest build of each system, by its name.
[[nodiscard]] std::map<std::string, std::string> newest_builds(std::span<const StoredRun> runs);

/// The build with a name or unique prefix. A build with uncommitted changes ("abc123+ff00") is another one
/// than its commit: a name without "+" is no prefix of it.
/// @param place of the name, for messages
/// @throws InputError if there is none, or more than one; the message lists the builds
[[nodiscard]] std::string build_named(std::span<const StoredRun> runs, const std::string& name,
                                      const std::string& place);

/// Divides runs into groups. If a variant was executed with several configs in one group, only its newest
/// config is kept, and of each sequence only the newest data. Runs of external systems, whose builds are
/// their own, are kept with the newest build and with all.
/// @param runs  of `store`; headers suffice, the details of the selected ones are read
/// @param build a build or a unique prefix of one, "all", or empty for the newest one
/// @throws InputError if there is no such build, or if the prefix is ambiguous; the message lists the builds
[[nodiscard]] RunSelection select_runs(const Store& store, std::vector<StoredRun> runs,
                                       const std::string& build);

}  // namespace stillpoint::bench
