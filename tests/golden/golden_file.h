// SPDX-License-Identifier: BSD-3-Clause
/// What the public tools printed on the shared trajectories.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <string>

#include "tests/support/test_data.h"

namespace stillpoint::test {

/// A golden file (Python's NaN and Infinity as null) from the folder beside the real data (see test_data.h),
/// or nothing where it is absent.
inline std::optional<nlohmann::json> golden_file(const std::string& name) {
  const std::optional<std::filesystem::path> path = find_test_data("../golden/" + name);
  if (!path) return std::nullopt;
  std::ifstream stream(*path);
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  return nlohmann::json::parse(std::regex_replace(text, std::regex(": (NaN|Infinity)"), ": null"));
}

/// A number as the tools print it: in units of the sixth decimal.
inline long long printed(double value) { return std::llround(value * 1e6); }

}  // namespace stillpoint::test
