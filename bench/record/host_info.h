// SPDX-License-Identifier: BSD-3-Clause
/// The machine that a run was made on, as far as it bears on its numbers.
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace stillpoint {

struct HostInfo {
  std::string cpu;  ///< model name; "unknown" if the system does not tell
  unsigned logical_cpus = 0;
  std::string kernel;
  std::optional<std::string> governor;  ///< of the first CPU's clock, where readable
};

[[nodiscard]] HostInfo host_info();

/// As manifests have it.
[[nodiscard]] nlohmann::ordered_json host_json(const HostInfo& host);

}  // namespace stillpoint
