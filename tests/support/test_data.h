// SPDX-License-Identifier: BSD-3-Clause
/// Where tests find the real data that the project does not carry.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace stillpoint {

/// `relative` below the folder named by the environment variable STILLPOINT_DATA, else below ../shared/data
/// beside the sources; nothing where it is in neither.
inline std::optional<std::filesystem::path> find_test_data(const std::string& relative) {
  const char* const named = std::getenv("STILLPOINT_DATA");
  const std::filesystem::path beside = std::filesystem::path(STILLPOINT_SOURCE_DIR) / "../shared/data";
  const std::filesystem::path path = (named != nullptr ? std::filesystem::path(named) : beside) / relative;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

/// What a test says when it is skipped for want of `relative`.
inline std::string missing_test_data(const std::string& relative) {
  return relative + " is not at hand; set STILLPOINT_DATA to the folder of the real data";
}

}  // namespace stillpoint
