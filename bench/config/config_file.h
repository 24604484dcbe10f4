// SPDX-License-Identifier: BSD-3-Clause
/// Resolves configs: a base file with the files it inherits, then overlays, then single settings.
#pragma once

#include <string>
#include <vector>

#include "core/config/odometry_config.h"

namespace stillpoint::bench {

/// The config of a run.
struct ConfigRequest {
  std::string base = "stillpoint";    ///< embedded name or path of a file
  std::string variant;                ///< overlays joined by "+"; a base config among them replaces `base`
  std::vector<std::string> settings;  ///< "key=value", applied last
};

/// Reads and merges all files and settings of a request.
///
/// A file is a base if it is `dynamic_vins` or inherits it, directly or indirectly; any other is an overlay.
/// @throws InputError for unknown names, circular inheritance, two bases, and every fault of a file
[[nodiscard]] OdometryConfig load_config(const ConfigRequest& request);

}  // namespace stillpoint::bench
