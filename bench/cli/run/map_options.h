// SPDX-License-Identifier: BSD-3-Clause
/// The options --map and --save-map of `run`.
#pragma once

#include <memory>
#include <string>

#include "bench/run/loop_run.h"
#include "core/config/odometry_config.h"

namespace stillpoint::bench {

struct MapOptions {
  std::string load;       ///< map of an earlier run; empty = none
  std::string save;       ///< file for the map of this run; empty = none
  bool final_ba = false;  ///< global bundle adjustment after the last frame
};

/// Checks the options before the work begins.
/// @param runs number of runs of the command
/// @throws InputError without loop closure, for several runs with --save-map, and if the output file must not
/// be replaced
void require_map_options(const MapOptions& options, const OdometryConfig& config, std::size_t runs);

/// The map of --map, or null. @throws InputError as `read_map`
[[nodiscard]] std::shared_ptr<const KeyframeMap> load_map(const MapOptions& options);

/// Writes the map of --save-map, if any. With --map it contains the keyframes of both runs.
/// @throws InputError if the run was not located in the map of --map
void save_map(const MapOptions& options, const LoopReport& report);

}  // namespace stillpoint::bench
