// SPDX-License-Identifier: BSD-3-Clause
/// Seeded random numbers for tests.
#pragma once

#include <random>

#include <Eigen/Core>

namespace stillpoint {

class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967295.0;
  }
  double normal() { return normal_(engine_); }

  // Compilers evaluate arguments in different orders: the last component is drawn first.
  Eigen::Vector2d normal2() {
    const double y = normal(), x = normal();
    return {x, y};
  }
  Eigen::Vector3d normal3() {
    const double z = normal(), y = normal(), x = normal();
    return {x, y, z};
  }
  Eigen::Vector2d uniform2(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
    const double y = uniform(low.y(), high.y()), x = uniform(low.x(), high.x());
    return {x, y};
  }
  Eigen::Vector3d uniform3(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
    const double z = uniform(low.z(), high.z());
    const Eigen::Vector2d xy = uniform2(low.head<2>(), high.head<2>());
    return {xy.x(), xy.y(), z};
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace stillpoint
