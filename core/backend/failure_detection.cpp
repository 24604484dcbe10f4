// SPDX-License-Identifier: BSD-3-Clause
#include "core/backend/failure_detection.h"

namespace stillpoint {
namespace {

constexpr double kMaxAccelBias = 2.5;  // [m/s^2]
constexpr double kMaxGyroBias = 1.0;   // [rad/s]
constexpr double kMaxJump_m = 5.0;     // between successive frames

}  // namespace

bool has_failed(const NavState& before, const NavState& now) {
  const bool finite = now.T_w_b.p.allFinite() && now.T_w_b.q.coeffs().allFinite() && now.v_w.allFinite();
  return !finite || now.accel_bias.norm() > kMaxAccelBias || now.gyro_bias.norm() > kMaxGyroBias ||
         (now.T_w_b.p - before.T_w_b.p).norm() > kMaxJump_m;
}

}  // namespace stillpoint
