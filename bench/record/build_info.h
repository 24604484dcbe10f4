// SPDX-License-Identifier: BSD-3-Clause
/// What the program was built from and with; baked in by scripts/cmake/build_info.cmake.
#pragma once

#include <map>
#include <string>

namespace stillpoint {

struct BuildInfo {
  std::string version;      ///< of the project
  std::string git_commit;   ///< of the sources; "unknown" outside a repository
  std::string git_time;     ///< when it was committed, UTC, ISO 8601; empty outside a repository
  bool git_dirty = false;   ///< the sources differed from the commit
  std::string git_changes;  ///< hash of these differences; empty without any
  std::string build_type;
  std::string compiler;
  std::string flags;
  std::map<std::string, std::string> packages;  ///< library to version
};

[[nodiscard]] const BuildInfo& build_info();

}  // namespace stillpoint
