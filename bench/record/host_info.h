// SPDX-License-Identifier: BSD-3-Clause
/// Hardware and operating system of a run, as far as they affect its results.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "bench/profile/meters/device_info.h"

namespace stillpoint::bench {

struct HostInfo {
  std::string cpu;  ///< model name; "unknown" if not available
  unsigned logical_cpus = 0;
  std::string kernel;
  std::optional<std::string> governor;  ///< frequency scaling governor, if available
  DeviceInfo device;
};

/// @param root "/", or a folder with a recorded "sys", of which governor and device are read
[[nodiscard]] HostInfo host_info(const std::filesystem::path& root = "/");

/// JSON of manifests.
[[nodiscard]] nlohmann::ordered_json host_json(const HostInfo& host);

}  // namespace stillpoint::bench
