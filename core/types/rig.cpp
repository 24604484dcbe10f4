// SPDX-License-Identifier: BSD-3-Clause
#include "core/types/rig.h"

#include <Eigen/LU>

namespace stillpoint {

ImuSample ImuAxes::corrected(const ImuSample& measured) const {
  return {measured.t, gyro.inverse() * measured.gyro_b, accel.inverse() * measured.accel_b};
}

}  // namespace stillpoint
