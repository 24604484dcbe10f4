// SPDX-License-Identifier: BSD-3-Clause
/// Quick indicators, after a run, that its data or calibration is not what is stated.
#pragma once

#include <string>
#include <vector>

#include "bench/run/run_result.h"

namespace stillpoint::bench {

/// One phrase per indicator that is off: NIS of images above 4 or of the IMU above 3, errors of the IMU above
/// 5 times the stated noise, a parameter of the rig that differs, or a tenth of the frames after the first
/// second without a pose.
[[nodiscard]] std::vector<std::string> run_indicators(const RunResult& result);

}  // namespace stillpoint::bench
