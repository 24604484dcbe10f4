// SPDX-License-Identifier: BSD-3-Clause
/// Random whole numbers that are the same with every standard library.
#pragma once

#include <cstddef>
#include <random>

namespace stillpoint {

/// A whole number below `count`, > 0. The standard's distribution differs between libraries; this does not.
[[nodiscard]] inline std::size_t draw(std::mt19937_64& random, std::size_t count) {
  return static_cast<std::size_t>((static_cast<unsigned __int128>(random()) * count) >> 64);
}

}  // namespace stillpoint
