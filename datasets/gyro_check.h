// SPDX-License-Identifier: BSD-3-Clause
/// Compares the gyroscope with the ground truth: axes, unit, clocks.
#pragma once

#include <optional>
#include <string>

#include "datasets/io/sequence_info.h"

namespace stillpoint::datasets {

/// Compares the mean angular rates of the gyroscope, without the mean difference (its bias), with those of
/// the ground truth in the body frame, over windows of 1 s in which one of them rotates by 0.05 rad/s. A
/// difference of 20 % (`relative_residual`), or a lag of 20 ms that makes the rates between images agree
/// better, is a finding, with what makes both agree: the lag, a factor, other axes, or a rotation between the
/// frames.
/// @return nullopt without a finding; with fewer than five such windows; without orientations in the truth;
/// if the rates are in deg/s, which `imu_unit_findings` tells
[[nodiscard]] std::optional<std::string> gyro_truth_finding(const SequenceInfo& info);

}  // namespace stillpoint::datasets
