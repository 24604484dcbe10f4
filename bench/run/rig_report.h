// SPDX-License-Identifier: BSD-3-Clause
/// What a run found out about the calibration that it was given.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bench/run/odometry_run.h"

namespace stillpoint::bench {

enum class RigResult { kAgrees, kDiffers, kNotObserved };

/// One parameter of the rig, in the unit of its name.
struct RigFinding {
  std::string parameter;  ///< such as "focal length [%]"
  RigResult result = RigResult::kNotObserved;
  double difference = 0.0;  ///< of the true value from the stated one; zero unless it differs
  double sigma = 0.0;       ///< standard deviation of the estimate
};

/// A parameter is not observed if its standard deviation is above half of what calibrations of consumer
/// devices are off by (5 % of the depth scale, 1 % of the focal length, 0.025 of k1, 0.5 % of the focal
/// length for the center, 5 ms, half a degree). With the deviation s of its estimate and of what a
/// calibration leaves (rig_tolerance.h), it differs if its group contradicts the rig (see Calibration; the
/// time offset, and the rotation by the alignment at the start, always count as such) and it is off by more
/// than 3 s, and agrees if it is observed and off by at most 2 s.
/// @return nothing about parameters that were not estimated, and without `backend.covariance`
[[nodiscard]] std::vector<RigFinding> rig_report(const EstimatedCalibration& calibration);

/// "agrees", "differs" or "not observed".
[[nodiscard]] std::string_view result_name(RigResult result);

/// "focal length [%]: differs by -1.85 (18 sigma); k1: agrees (to 0.001); ...".
[[nodiscard]] std::string rig_report_line(const std::vector<RigFinding>& findings);

}  // namespace stillpoint::bench
