// SPDX-License-Identifier: BSD-3-Clause
/// Seeded random numbers for tests.
#pragma once

#include <random>

namespace stillpoint {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967295.0;
  }
  double normal() { return normal_(engine_); }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace stillpoint
