// SPDX-License-Identifier: BSD-3-Clause
/// Access to the reference output of public tools on the shared trajectories.
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

/// A golden file from the folder next to the real data (see test_data.h), with Python's NaN and Infinity
/// replaced by null; nullopt if the file does not exist.
inline std::optional<nlohmann::json> golden_file(const std::string& name) {
  const std::optional<std::filesystem::path> path = find_test_data("../golden/" + name);
  if (!path) return std::nullopt;
  std::ifstream stream(*path);
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  return nlohmann::json::parse(std::regex_replace(text, std::regex(": (NaN|Infinity)"), ": null"));
}

/// A number rounded to six decimals, as printed by the tools, in units of 1e-6.
inline long long printed(double value) { return std::llround(value * 1e6); }

}  // namespace stillpoint::test
