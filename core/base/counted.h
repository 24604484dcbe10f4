// SPDX-License-Identifier: BSD-3-Clause
/// Numbers with their nouns.
#pragma once

#include <cstddef>
#include <string>

namespace stillpoint {

/// "1 run", "2 runs".
[[nodiscard]] inline std::string counted(std::size_t count, const std::string& noun) {
  return std::to_string(count) + ' ' + noun + (count == 1 ? "" : "s");
}

}  // namespace stillpoint
