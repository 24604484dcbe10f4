// SPDX-License-Identifier: BSD-3-Clause
/// Checks that the recorded sequences of a plan have the boxes that its configs require.
#pragma once

#include "bench/plan/plan_matrix.h"

namespace stillpoint::bench {

/// @throws InputError naming the first run whose sequence has no detections.txt although its config uses
/// recorded boxes; runs of external systems and of other programs are not checked
void require_recorded_boxes(const PlanMatrix& matrix);

}  // namespace stillpoint::bench
