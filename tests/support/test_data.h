// SPDX-License-Identifier: BSD-3-Clause
/// Location of real datasets that are not part of the repository.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace stillpoint {

/// `relative` in the folder given by the environment variable STILLPOINT_DATA, by default ../shared/data next
/// to the sources; nullopt if it does not exist.
inline std::optional<std::filesystem::path> find_test_data(const std::string& relative) {
  const char* const named = std::getenv("STILLPOINT_DATA");
  const std::filesystem::path beside = std::filesystem::path(STILLPOINT_SOURCE_DIR) / "../shared/data";
  const std::filesystem::path path = (named != nullptr ? std::filesystem::path(named) : beside) / relative;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

/// Message of a test that is skipped because `relative` is missing.
inline std::string missing_test_data(const std::string& relative) {
  return relative + " is not available; set STILLPOINT_DATA to the folder of the datasets";
}

}  // namespace stillpoint
