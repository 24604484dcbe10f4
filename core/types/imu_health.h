// SPDX-License-Identifier: BSD-3-Clause
/// Counts of irregularities in the IMU stream; reported with the run.
#pragma once

namespace stillpoint {

struct ImuHealth {
  int rejected_samples = 0;  ///< not finite, out of order or repeated
  int gaps = 0;              ///< gaps longer than `imu.max_gap_s` in extracted intervals, each counted once
};

}  // namespace stillpoint
