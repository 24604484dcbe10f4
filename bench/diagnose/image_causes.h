// SPDX-License-Identifier: BSD-3-Clause
/// Faults of images, depth and stamps.
#pragma once

#include <vector>

#include "bench/diagnose/cause.h"
#include "bench/diagnose/evidence/depth_alignment.h"
#include "bench/diagnose/evidence/recording_survey.h"

namespace stillpoint::bench {

/// Missing, repeated, uniform, dark, saturated and blurred frames, changes of exposure, missing, repeated and
/// late depth, the unit of depth, gaps and rounding of stamps.
[[nodiscard]] std::vector<Cause> image_causes(const datasets::SequenceInfo& info,
                                              const RecordingSurvey& survey);

/// Depth of another time or place than its images.
[[nodiscard]] std::vector<Cause> alignment_causes(const DepthAlignment& alignment);

}  // namespace stillpoint::bench
