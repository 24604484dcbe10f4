// SPDX-License-Identifier: BSD-3-Clause
/// Uniform random integers that are identical with every standard library.
#pragma once

#include <cstddef>
#include <random>

namespace stillpoint::eval {

/// Uniform integer in [0, count), count > 0: floor(u * count / 2^64) with u from the generator. Unlike
/// std::uniform_int_distribution its sequence does not depend on the standard library.
[[nodiscard]] inline std::size_t random_index(std::mt19937_64& random, std::size_t count) {
  return static_cast<std::size_t>((static_cast<unsigned __int128>(random()) * count) >> 64);
}

}  // namespace stillpoint::eval
