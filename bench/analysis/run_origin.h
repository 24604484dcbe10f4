// SPDX-License-Identifier: BSD-3-Clause
/// Where a run comes from, by its manifest: commit, machine and config.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/store/store.h"

namespace stillpoint::bench {

/// `RunIdentity::system` of this odometry.
inline constexpr const char* kOwnSystem = "stillpoint";

struct RunOrigin {
  std::string commit;  ///< git commit, with "+" and a hash of uncommitted changes if any; else the build name
  std::string time;    ///< UTC commit time; empty if not in the manifest
  std::string host;    ///< CPU model and count: "Intel(R) N100, 4 processors"
  /// Identifies the config without its seeds, so that it is equal for replicates. Empty if unknown.
  std::string config;
};

/// A run without a manifest (interrupted) is assigned to the machine of the previous run, and to the config
/// of the runs with the same config hash.
/// @param runs in the order of their start
/// @return one element per run
[[nodiscard]] std::vector<RunOrigin> run_origins(const Store& store, std::span<const StoredRun> runs);

}  // namespace stillpoint::bench
