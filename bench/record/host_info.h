// SPDX-License-Identifier: BSD-3-Clause
/// Hardware and operating system of a run, as far as they affect its results.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace stillpoint::bench {

struct HostInfo {
  std::string cpu;  ///< model name; "unknown" if not available
  unsigned logical_cpus = 0;
  std::string kernel;
  std::optional<std::string> governor;  ///< frequency scaling governor of the first CPU, if available
};

[[nodiscard]] HostInfo host_info();

/// JSON of manifests.
[[nodiscard]] nlohmann::ordered_json host_json(const HostInfo& host);

}  // namespace stillpoint::bench
