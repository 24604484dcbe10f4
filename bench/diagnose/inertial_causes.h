// SPDX-License-Identifier: BSD-3-Clause
/// Faults of inertial samples and their calibration, by comparison with gravity and the motion in images.
#pragma once

#include <vector>

#include "bench/diagnose/cause.h"
#include "bench/diagnose/evidence/recording_survey.h"

namespace stillpoint::bench {

/// Units, axes, rotation and clock of the IMU, gaps, rate, jitter and saturation of its samples. Wrong units
/// come alone: the other checks require right ones. Beside the rotation is the center that looks like it,
/// which only a run that does not observe the center leaves open.
[[nodiscard]] std::vector<Cause> inertial_causes(const datasets::SequenceInfo& info,
                                                 const RecordingSurvey& survey);

/// A camera that moves in the first second: biases and gravity are then found in motion. The frames concerned
/// are those of the first two seconds.
[[nodiscard]] std::vector<Cause> start_causes(const datasets::SequenceInfo& info,
                                              const RecordingSurvey& survey);

}  // namespace stillpoint::bench
