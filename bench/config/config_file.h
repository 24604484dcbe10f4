// SPDX-License-Identifier: BSD-3-Clause
/// Resolves configs: a base file, what it inherits, overlays on top, and single settings last.
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/odometry_config.h"

namespace stillpoint {

/// Which config a run asks for.
struct ConfigRequest {
  std::string base = "stillpoint";  ///< embedded name or file
  std::string variant;              ///< overlays joined by "+"; one of them may be a base and replaces `base`
  std::vector<std::string> settings;  ///< "key=value", applied last
};

/// Reads and merges everything a request names.
///
/// A file is a base when it is `dynamic_vins` or inherits it, however indirectly; any other is an overlay.
/// @throws InputError for unknown names, inheritance in a circle, two bases, and every fault of a file
[[nodiscard]] OdometryConfig load_config(const ConfigRequest& request);

}  // namespace stillpoint
