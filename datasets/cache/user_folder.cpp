// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/cache/user_folder.h"

#include <cstdlib>

namespace stillpoint::datasets {

namespace fs = std::filesystem;

fs::path variable_or_empty(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? fs::path{} : fs::path(value);
}

fs::path user_folder(const char* xdg, const fs::path& below_home) {
  if (const fs::path users = variable_or_empty(xdg); !users.empty()) return users / "stillpoint";
  const fs::path home = variable_or_empty("HOME");
  return home.empty() ? home : home / below_home / "stillpoint";
}

}  // namespace stillpoint::datasets
